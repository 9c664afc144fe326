// The few types of godot-cpp 4.1 that the class uses, as far as a compiler must know them to check its syntax
// and types. Not godot-cpp.
#pragma once
#include <cstdint>
#include <type_traits>

using GDExtensionBool = std::uint8_t;
using GDExtensionClassLibraryPtr = void*;
using GDExtensionInterfaceFunctionPtr = void (*)();
using GDExtensionInterfaceGetProcAddress = GDExtensionInterfaceFunctionPtr (*)(const char*);
struct GDExtensionInitialization {};
#define GDE_EXPORT __attribute__((visibility("default")))
#define DEFVAL(value) (value)
#define GDCLASS(name, base)                                                            \
 private:                                                                              \
  friend class ::godot::ClassDB;                                                       \
  void operator=(const name&) {}                                                       \
  static_assert(std::is_base_of_v<::godot::Wrapped, base>, "a class of the engine's"); \
                                                                                       \
 private:

namespace godot {

class ClassDB;
class Wrapped {
 protected:
  Wrapped() = default;
  virtual ~Wrapped() = default;
  static void _bind_methods() {}
};
class Object : public Wrapped {};
class RefCounted : public Object {};

struct CharString {
  const char* get_data() const { return ""; }
};
struct String {
  String() = default;
  String(const char*) {}
  CharString utf8() const { return {}; }
  static String utf8(const char*, std::int64_t = -1) { return {}; }
};
struct Variant {
  Variant(bool) {}
  Variant(std::int64_t) {}
  Variant(int) {}
  Variant(double) {}
  Variant(const char*) {}
  Variant(const String&) {}
};
struct Vector2 {
  Vector2() = default;
  Vector2(float, float) {}
  float x = 0, y = 0;
};
struct Vector3 {
  Vector3() = default;
  Vector3(float, float, float) {}
  float x = 0, y = 0, z = 0;
};

template <class T>
struct PackedArray {
  std::int64_t size() const { return 0; }
  std::int64_t resize(std::int64_t) { return 0; }
  const T* ptr() const { return nullptr; }
  T* ptrw() { return nullptr; }
};
struct PackedByteArray : PackedArray<std::uint8_t> {};
struct PackedInt32Array : PackedArray<std::int32_t> {};
struct PackedVector2Array : PackedArray<Vector2> {};
struct PackedVector3Array : PackedArray<Vector3> {};

struct MethodDefinition {
  int argument_count;
};
template <class... Names>
MethodDefinition D_METHOD(const char*, Names...) {
  static_assert((std::is_convertible_v<Names, const char*> && ...), "arguments have names");
  return {sizeof...(Names)};
}
/// A type that Godot can pass to a method or take from it.
template <class T>
constexpr bool can_be_passed =
    std::is_void_v<T> || std::is_arithmetic_v<T> || std::is_same_v<T, String> || std::is_same_v<T, Vector3> ||
    std::is_same_v<T, PackedByteArray> || std::is_same_v<T, PackedInt32Array> ||
    std::is_same_v<T, PackedVector2Array> || std::is_same_v<T, PackedVector3Array>;
class ClassDB {
 public:
  template <class T>
  static void register_class() {
    static_assert(std::is_default_constructible_v<T>);
    T::_bind_methods();
  }
  template <class Result, class T, class... Arguments, class... Defaults>
  static void bind_method(MethodDefinition, Result (T::*)(Arguments...), Defaults... defaults) {
    check<Result, Arguments...>(defaults...);
  }
  template <class Result, class T, class... Arguments, class... Defaults>
  static void bind_method(MethodDefinition, Result (T::*)(Arguments...) const, Defaults... defaults) {
    check<Result, Arguments...>(defaults...);
  }

 private:
  template <class Result, class... Arguments, class... Defaults>
  static void check(const Defaults&... defaults) {
    static_assert(can_be_passed<Result> && (can_be_passed<std::remove_cvref_t<Arguments>> && ...));
    static_assert(sizeof...(Defaults) <= sizeof...(Arguments));
    (static_cast<void>(Variant(defaults)), ...);
  }
};

struct UtilityFunctions {
  template <class... More>
  static void push_error(const Variant&, const More&... more) {
    (static_cast<void>(Variant(more)), ...);
  }
};

enum ModuleInitializationLevel { MODULE_INITIALIZATION_LEVEL_CORE, MODULE_INITIALIZATION_LEVEL_SCENE = 2 };
struct GDExtensionBinding {
  using Callback = void (*)(ModuleInitializationLevel);
  struct InitObject {
    InitObject(GDExtensionInterfaceGetProcAddress, GDExtensionClassLibraryPtr, GDExtensionInitialization*) {}
    void register_initializer(Callback) const {}
    void register_terminator(Callback) const {}
    void set_minimum_library_initialization_level(ModuleInitializationLevel) const {}
    GDExtensionBool init() const { return 1; }
  };
};

}  // namespace godot
