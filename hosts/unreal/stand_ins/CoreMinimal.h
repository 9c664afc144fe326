// The few engine types that the plugin uses, as far as a compiler must know them to check its syntax. Not the
// engine.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <utility>
using int32 = std::int32_t;
using uint32 = std::uint32_t;
using uint8 = std::uint8_t;
#define TEXT(text) text
#define TCHAR char
#define UPROPERTY(...)
#define UFUNCTION(...)
#define UCLASS(...)
#define GENERATED_BODY() \
 public:                 \
  using Super = UProceduralMeshComponent;
#define UE_LOG(category, verbosity, format, ...) category(format, __VA_ARGS__)
#define DEFINE_LOG_CATEGORY_STATIC(name, ...) \
  static void name(const char*, ...) {}
#define IMPLEMENT_MODULE(type, name)
#define UTF8_TO_TCHAR(text) text
#define TCHAR_TO_UTF8(text) text
struct FString {
  const char* operator*() const { return ""; }
  bool IsEmpty() const { return true; }
};
struct FName {
  FString ToString() const { return {}; }
};
struct FFilePath {
  FString FilePath;
};
struct FVector {
  double X = 0, Y = 0, Z = 0;
  FVector() = default;
  FVector(double x, double y, double z) : X(x), Y(y), Z(z) {}
  FVector operator*(double) const { return {}; }
  FVector operator/(double) const { return {}; }
};
struct FVector2D {
  FVector2D() = default;
  FVector2D(double, double) {}
};
struct FColor {};
struct FProcMeshTangent {};
template <class T>
struct TArray {
  TArray() = default;
  TArray(std::initializer_list<T>) {}
  const T* GetData() const { return nullptr; }
  int32 Num() const { return 0; }
  void SetNumUninitialized(int32, bool) {}
  void Append(std::initializer_list<T>) {}
  T& operator[](uint32) { return *only; }
  T* only = nullptr;
};
template <class K, class V>
struct TPair {
  K Key;
  V Value;
};
template <class K, class V>
struct TMap {
  const TPair<K, V>* begin() const { return nullptr; }
  const TPair<K, V>* end() const { return nullptr; }
};
namespace EAxis {
enum Type { X, Y, Z };
}
namespace EEndPlayReason {
enum Type { Destroyed };
}
enum ELevelTick { LEVELTICK_All };
struct FTransform {
  FVector GetUnitAxis(EAxis::Type) const { return {}; }
  FVector GetLocation() const { return {}; }
};
struct FMath {
  static float Clamp(float v, float, float) { return v; }
};
struct FActorComponentTickFunction {
  bool bCanEverTick = false;
};
struct FObjectInitializer {};
