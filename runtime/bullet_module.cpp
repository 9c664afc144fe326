#include "runtime/bullet_module.h"

#include <string>

#include "runtime/message.h"

#if defined(_WIN32)
#define WIN32_LEAN_AND_MEAN
#define NOMINMAX
#include <windows.h>
#elif !defined(__EMSCRIPTEN__)
#include <dlfcn.h>
#endif

// What systems differ in: opening a library that lies beside this one.
namespace fascia::runtime {
namespace {

#if defined(_WIN32)

using Module = HMODULE;
constexpr const char* module_name = "fascia_bullet.dll";

std::string own_path() {
  HMODULE self = nullptr;
  char path[4096] = {};
  const DWORD by_address =
      GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
  if (!GetModuleHandleExA(by_address, reinterpret_cast<LPCSTR>(&bullet_entry), &self)) return "";
  return {path, GetModuleFileNameA(self, path, sizeof path)};
}

Module open(const std::string& path) {
  return LoadLibraryA(path.c_str());
}

void* find(Module module, const char* name) {
  return reinterpret_cast<void*>(GetProcAddress(module, name));
}

#elif defined(__EMSCRIPTEN__)

using Module = void*;
constexpr const char* module_name = "libfascia_bullet";

std::string own_path() {
  return "";
}

Module open(const std::string&) {
  return nullptr;
}

void* find(Module, const char*) {
  return nullptr;
}

#else

using Module = void*;
#if defined(__APPLE__)
constexpr const char* module_name = "libfascia_bullet.dylib";
#else
constexpr const char* module_name = "libfascia_bullet.so";
#endif

std::string own_path() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&fascia_version), &info) == 0 || info.dli_fname == nullptr)
    return "";
  return info.dli_fname;
}

Module open(const std::string& path) {
  return dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
}

void* find(Module module, const char* name) {
  return dlsym(module, name);
}

#endif

/// Folder this library lies in, with a slash at its end; empty when it is not known.
std::string own_folder() {
  const std::string path = own_path();
  const std::size_t slash = path.find_last_of("/\\");
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

}  // namespace

sim::MakeSolver bullet_entry() {
  static const Module module = [] {
    const Module beside = open(own_folder() + module_name);
    return beside != nullptr ? beside : open(module_name);
  }();
  if (module == nullptr)
    throw Failure(FASCIA_ERROR_MODULE,
                  "the module libfascia_bullet is not there; install it beside this library, or use "
                  "FASCIA_SOLVER_OWN");
  void* const entry = find(module, sim::solver_entry);
  if (entry == nullptr)
    throw Failure(FASCIA_ERROR_MODULE, "libfascia_bullet is of another version than this library");
  return reinterpret_cast<sim::MakeSolver>(entry);
}

}  // namespace fascia::runtime
