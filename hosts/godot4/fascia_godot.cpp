// A face in Godot 4: the class FasciaFace on godot-cpp (4.1 and later). The methods are those of the Godot 3
// class.
#include <fascia/fascia.h>

#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/godot.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/utility_functions.hpp>

namespace {

class FasciaFace : public godot::RefCounted {
  GDCLASS(FasciaFace, godot::RefCounted)

 public:
  ~FasciaFace() override { drop(); }

  bool load(const godot::PackedByteArray& bytes, int level) {
    drop();
    fascia_face_options options = fascia_default_face_options();
    options.level = level;
    if (passes(fascia_asset_load(bytes.ptr(), static_cast<size_t>(bytes.size()), &asset_)) &&
        passes(fascia_face_create(asset_, &options, &face_)))
      return true;
    drop();
    return false;
  }

  bool set_value(const godot::String& name, double value) {
    return face_ != nullptr &&
           passes(fascia_face_set(face_, name.utf8().get_data(), static_cast<float>(value)));
  }
  bool clear() { return face_ != nullptr && passes(fascia_face_clear(face_)); }
  bool pose() { return face_ != nullptr && passes(fascia_face_pose(face_)); }
  bool reset() { return face_ != nullptr && passes(fascia_face_reset(face_)); }
  bool step(double seconds) {
    return face_ != nullptr &&
           passes(fascia_face_step(face_, static_cast<float>(seconds < 1.0 ? seconds : 1.0)));
  }
  bool set_level(int level, double seconds) {
    return face_ != nullptr && passes(fascia_face_set_level(face_, level, static_cast<float>(seconds)));
  }
  /// `point` in metres in the head's frame.
  bool look_at(const godot::Vector3& point, double weight) {
    const float place[3] = {static_cast<float>(point.x), static_cast<float>(point.y),
                            static_cast<float>(point.z)};
    return face_ != nullptr && passes(fascia_face_look_at(face_, place, static_cast<float>(weight)));
  }

  int mesh_count() const {
    fascia_asset_info info = {};
    info.struct_size = sizeof info;
    return asset_ != nullptr && fascia_asset_get_info(asset_, &info) == FASCIA_OK
               ? static_cast<int>(info.mesh_count)
               : 0;
  }
  godot::String part(int mesh) const { return godot::String::utf8(shape(mesh).part); }
  godot::PackedVector3Array positions(int mesh) { return vectors(mesh, fascia_face_positions); }
  godot::PackedVector3Array normals(int mesh) { return vectors(mesh, fascia_face_normals); }
  /// Empty if the file has none; with the origin at the top left of an image, as Godot's.
  godot::PackedVector2Array texcoords(int mesh) const {
    godot::PackedVector2Array result;
    fascia_vectors list = {};
    list.struct_size = sizeof list;
    if (asset_ == nullptr || !passes(fascia_asset_texcoords(asset_, static_cast<uint32_t>(mesh), &list)))
      return result;
    result.resize(list.count);
    godot::Vector2* to = result.ptrw();
    for (uint32_t v = 0; v < list.count; ++v)
      to[v] = godot::Vector2(list.data[2 * v], list.data[2 * v + 1]);
    return result;
  }
  /// Wound as Godot wants them: clockwise seen from outside.
  godot::PackedInt32Array triangles(int mesh) const {
    const fascia_mesh_info info = shape(mesh);
    godot::PackedInt32Array result;
    result.resize(3 * static_cast<int64_t>(info.triangle_count));
    int32_t* to = result.ptrw();
    for (uint32_t t = 0; t < info.triangle_count; ++t) {
      to[3 * t] = static_cast<int32_t>(info.triangles[3 * t]);
      to[3 * t + 1] = static_cast<int32_t>(info.triangles[3 * t + 2]);
      to[3 * t + 2] = static_cast<int32_t>(info.triangles[3 * t + 1]);
    }
    return result;
  }

 protected:
  static void _bind_methods() {
    using godot::ClassDB;
    using godot::D_METHOD;
    ClassDB::bind_method(D_METHOD("load", "bytes", "level"), &FasciaFace::load, DEFVAL(-1));
    ClassDB::bind_method(D_METHOD("set_value", "name", "value"), &FasciaFace::set_value);
    ClassDB::bind_method(D_METHOD("clear"), &FasciaFace::clear);
    ClassDB::bind_method(D_METHOD("pose"), &FasciaFace::pose);
    ClassDB::bind_method(D_METHOD("reset"), &FasciaFace::reset);
    ClassDB::bind_method(D_METHOD("step", "seconds"), &FasciaFace::step);
    ClassDB::bind_method(D_METHOD("set_level", "level", "seconds"), &FasciaFace::set_level, DEFVAL(0.25));
    ClassDB::bind_method(D_METHOD("look_at", "point", "weight"), &FasciaFace::look_at, DEFVAL(1.0));
    ClassDB::bind_method(D_METHOD("mesh_count"), &FasciaFace::mesh_count);
    ClassDB::bind_method(D_METHOD("part", "mesh"), &FasciaFace::part);
    ClassDB::bind_method(D_METHOD("positions", "mesh"), &FasciaFace::positions);
    ClassDB::bind_method(D_METHOD("normals", "mesh"), &FasciaFace::normals);
    ClassDB::bind_method(D_METHOD("texcoords", "mesh"), &FasciaFace::texcoords);
    ClassDB::bind_method(D_METHOD("triangles", "mesh"), &FasciaFace::triangles);
  }

 private:
  static bool passes(fascia_result result) {
    if (result == FASCIA_OK || result == FASCIA_ERROR_DIVERGED) return true;
    godot::UtilityFunctions::push_error("FasciaFace: ", fascia_last_message());
    return false;
  }
  void drop() {
    fascia_face_release(face_);
    fascia_asset_release(asset_);
    face_ = nullptr;
    asset_ = nullptr;
  }
  fascia_mesh_info shape(int mesh) const {
    fascia_mesh_info info = {};
    info.struct_size = sizeof info;
    info.part = "";
    if (asset_ != nullptr) passes(fascia_asset_get_mesh(asset_, static_cast<uint32_t>(mesh), &info));
    return info;
  }
  template <class Function>
  godot::PackedVector3Array vectors(int mesh, Function function) {
    godot::PackedVector3Array result;
    fascia_vectors list = {};
    list.struct_size = sizeof list;
    if (face_ == nullptr || !passes(function(face_, static_cast<uint32_t>(mesh), &list))) return result;
    result.resize(list.count);
    godot::Vector3* to = result.ptrw();
    for (uint32_t v = 0; v < list.count; ++v)
      to[v] = godot::Vector3(list.data[3 * v], list.data[3 * v + 1], list.data[3 * v + 2]);
    return result;
  }

  fascia_asset* asset_ = nullptr;
  fascia_face* face_ = nullptr;
};

void begin(godot::ModuleInitializationLevel level) {
  if (level == godot::MODULE_INITIALIZATION_LEVEL_SCENE) godot::ClassDB::register_class<FasciaFace>();
}

void end(godot::ModuleInitializationLevel) {}

}  // namespace

extern "C" GDExtensionBool GDE_EXPORT fascia_godot_init(GDExtensionInterfaceGetProcAddress address,
                                                        GDExtensionClassLibraryPtr library,
                                                        GDExtensionInitialization* initialization) {
  const godot::GDExtensionBinding::InitObject init(address, library, initialization);
  init.register_initializer(begin);
  init.register_terminator(end);
  init.set_minimum_library_initialization_level(godot::MODULE_INITIALIZATION_LEVEL_SCENE);
  return init.init();
}
