#include "gltf/read/model.h"

#include <new>

#include "geometry/error.h"
#include "geometry/json.h"
#include "gltf/read/container.h"

namespace fascia::gltf {
namespace {

bool ignore_image(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*,
                  int, void*) {
  return true;
}

}  // namespace

tinygltf::Model load_model(std::span<const uint8_t> glb, const std::string& name) {
  check_depth(glb_chunks(glb, name).json, name);
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(ignore_image, nullptr);
  // The file stands for itself: anything it names beside itself is not there.
  tinygltf::FsCallbacks no_files{};
  no_files.FileExists = [](const std::string&, void*) { return false; };
  no_files.ExpandFilePath = [](const std::string& path, void*) { return path; };
  no_files.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) {
    return false;
  };
  no_files.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  loader.SetFsCallbacks(no_files);
  tinygltf::Model model;
  std::string error, warning;
  bool read = false;
  try {
    read = loader.LoadBinaryFromMemory(&model, &error, &warning, glb.data(),
                                       static_cast<unsigned int>(glb.size()));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  while (!error.empty() && (error.back() == '\n' || error.back() == ' '))
    error.pop_back();
  if (!read) throw Error(name + ": not a sound glTF file: " + (error.empty() ? "unknown reason" : error));
  return model;
}

}  // namespace fascia::gltf
