# What `cmake --install` puts where, in components:
#   runtime      the shared library and the Bullet module
#   development  the C header, the static library, CMake package and pkg-config file
#   tool         the fascia command, its manual page and shell completions
#   snapshot     the library that compares a face's deformation with a recorded one
#   builder      the offline builder as static libraries with their C++ headers
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/fascia)
set(builder_headers ${CMAKE_INSTALL_INCLUDEDIR}/fascia-builder)

# fascia_closure(RESULT target...): these static and interface libraries of the project and all that they link.
function(fascia_closure result)
  set(found "")
  set(open ${ARGN})
  while(open)
    list(POP_FRONT open name)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" name "${name}")
    if(NOT TARGET "${name}")
      continue()
    endif()
    get_target_property(alias ${name} ALIASED_TARGET)
    if(alias)
      set(name ${alias})
    endif()
    get_target_property(imported ${name} IMPORTED)
    if(imported OR name IN_LIST found)
      continue()
    endif()
    list(APPEND found ${name})
    foreach(property LINK_LIBRARIES INTERFACE_LINK_LIBRARIES)
      get_target_property(links ${name} ${property})
      if(links)
        list(APPEND open ${links})
      endif()
    endforeach()
  endwhile()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# One static library for hosts that link the runtime in: the objects of every room it stands on.
fascia_closure(runtime_rooms fascia_runtime_core)
add_library(fascia_runtime_static STATIC ${PROJECT_SOURCE_DIR}/runtime/version.cpp)
foreach(room IN LISTS runtime_rooms)
  get_target_property(kind ${room} TYPE)
  if(kind STREQUAL "STATIC_LIBRARY")
    target_sources(fascia_runtime_static PRIVATE $<TARGET_OBJECTS:${room}>)
  endif()
endforeach()
target_include_directories(fascia_runtime_static PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/runtime/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_definitions(fascia_runtime_static INTERFACE FASCIA_STATIC)
target_link_libraries(fascia_runtime_static INTERFACE ${CMAKE_DL_LIBS})
set_target_properties(fascia_runtime_static PROPERTIES EXPORT_NAME runtime_static
  OUTPUT_NAME $<IF:$<BOOL:${WIN32}>,fascia_static,fascia>)
set_target_properties(fascia_runtime PROPERTIES EXPORT_NAME runtime)

install(TARGETS fascia_runtime EXPORT fascia_runtime_targets
  RUNTIME COMPONENT runtime
  LIBRARY COMPONENT runtime NAMELINK_COMPONENT development
  ARCHIVE COMPONENT development)
install(TARGETS fascia_runtime_static EXPORT fascia_runtime_targets ARCHIVE COMPONENT development)
install(EXPORT fascia_runtime_targets NAMESPACE fascia:: DESTINATION ${package_folder} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/runtime/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/runtime/shaders/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fascia/shaders COMPONENT development)
# The module lies beside the library that loads it.
if(TARGET fascia_bullet_module)
  install(TARGETS fascia_bullet_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime)
endif()

set(FASCIA_BUILDER_DEPENDENCIES Eigen3 nlohmann_json embree TBB)
if(TARGET fascia_gltf_edit)
  list(APPEND FASCIA_BUILDER_DEPENDENCIES draco meshoptimizer)
endif()
list(JOIN FASCIA_BUILDER_DEPENDENCIES " " FASCIA_BUILDER_DEPENDENCIES)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/fasciaConfig.cmake.in
  ${PROJECT_BINARY_DIR}/install/fasciaConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/install/fasciaConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
file(RELATIVE_PATH FASCIA_PREFIX_FROM_PKGCONFIG ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(${CMAKE_CURRENT_LIST_DIR}/fascia.pc.in ${PROJECT_BINARY_DIR}/install/fascia.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/install/fasciaConfig.cmake ${PROJECT_BINARY_DIR}/install/fasciaConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT development)
install(FILES ${PROJECT_BINARY_DIR}/install/fascia.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
# The licence and what changed, under the packages' names.
string(TIMESTAMP FASCIA_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH's where that is set
configure_file(${CMAKE_CURRENT_LIST_DIR}/debian_changelog.in ${PROJECT_BINARY_DIR}/install/changelog.Debian @ONLY)
find_program(FASCIA_GZIP gzip)
if(FASCIA_GZIP)
  execute_process(COMMAND ${FASCIA_GZIP} -9nf ${PROJECT_BINARY_DIR}/install/changelog.Debian)
  execute_process(COMMAND ${FASCIA_GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md
                  OUTPUT_FILE ${PROJECT_BINARY_DIR}/install/changelog.gz)
  set(changelogs ${PROJECT_BINARY_DIR}/install/changelog.gz ${PROJECT_BINARY_DIR}/install/changelog.Debian.gz)
endif()
set(FASCIA_PACKAGE_runtime libfascia${PROJECT_VERSION_MAJOR})
set(FASCIA_PACKAGE_development libfascia-dev)
set(FASCIA_PACKAGE_tool fascia)
set(FASCIA_PACKAGE_snapshot libfascia-snapshot${PROJECT_VERSION_MAJOR})
set(FASCIA_PACKAGE_builder libfascia-builder-dev)
# The licences of what is compiled in (scripts/sbom.sh lists the same), as Debian has them.
set(FASCIA_CONTAINED_runtime libeigen3-dev nlohmann-json3-dev libtinygltf-dev)
set(FASCIA_CONTAINED_development ${FASCIA_CONTAINED_runtime})
set(FASCIA_CONTAINED_snapshot ${FASCIA_CONTAINED_runtime} libtinyobjloader-dev libxxhash-dev)
set(FASCIA_CONTAINED_builder ${FASCIA_CONTAINED_snapshot} libnanoflann-dev)
set(FASCIA_CONTAINED_tool ${FASCIA_CONTAINED_builder} libcli11-dev libstb-dev libimgui-dev fonts-dejavu-core)
# Not meant for Debian's archive, so no bug of its tracker asks for them.
foreach(component runtime development tool snapshot builder)
  set(overrides ${PROJECT_BINARY_DIR}/install/overrides/${FASCIA_PACKAGE_${component}})
  file(WRITE ${overrides} "# Not meant for Debian's archive: no bug asks for the package.\n"
    "${FASCIA_PACKAGE_${component}}: initial-upload-closes-no-bugs *\n")
  if(component MATCHES "runtime|snapshot")
    file(APPEND ${overrides} "# CPack writes scripts that run ldconfig beside the trigger: the same, twice.\n"
      "${FASCIA_PACKAGE_${component}}: maintscript-calls-ldconfig *\n")
  endif()
  if(component STREQUAL "runtime")
    file(APPEND ${overrides} "# A module that the library beside it opens by this name; nothing links it.\n"
      "${FASCIA_PACKAGE_${component}}: sharedobject-in-library-directory-missing-soname *\n")
  endif()
  install(FILES ${overrides} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides COMPONENT ${component})
  set(documents ${CMAKE_INSTALL_DATADIR}/doc/${FASCIA_PACKAGE_${component}})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${documents} COMPONENT ${component} RENAME copyright)
  install(FILES ${changelogs} DESTINATION ${documents} COMPONENT ${component})
  foreach(package IN LISTS FASCIA_CONTAINED_${component})
    if(EXISTS /usr/share/doc/${package}/copyright)
      install(FILES /usr/share/doc/${package}/copyright DESTINATION ${documents}/third_party COMPONENT ${component}
        RENAME ${package}.txt)
    endif()
  endforeach()
endforeach()

if(FASCIA_BUILD_BUILDER)
  fascia_closure(builder_rooms fascia_rigging fascia_formats fascia_rig)
  foreach(room IN LISTS builder_rooms)
    string(REGEX REPLACE "^fascia_" "" name ${room})
    set_target_properties(${room} PROPERTIES EXPORT_NAME ${name})
  endforeach()
  install(TARGETS ${builder_rooms} EXPORT fascia_builder_targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/fascia-builder COMPONENT builder)
  install(EXPORT fascia_builder_targets NAMESPACE fascia:: DESTINATION ${package_folder} COMPONENT builder)
  foreach(room geometry gltf formats anatomy rig sim builder)
    if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/${room})
      install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room} DESTINATION ${builder_headers} COMPONENT builder
        FILES_MATCHING PATTERN "*.h")
    endif()
  endforeach()

  # Snapshots for other programs' tests: the C library and the CMake function.
  set_target_properties(fascia_snapshot_api PROPERTIES INSTALL_RPATH "$ORIGIN")
  install(TARGETS fascia_snapshot_api EXPORT fascia_builder_targets
    LIBRARY COMPONENT snapshot NAMELINK_COMPONENT builder)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/snapshot/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT builder)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/FasciaSnapshot.cmake DESTINATION ${package_folder} COMPONENT development)

  set_target_properties(fascia PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(TARGETS fascia RUNTIME COMPONENT tool)
  set(manual ${PROJECT_BINARY_DIR}/install/manual)
  set(manual_files "")
  foreach(kind man bash zsh fish)
    list(APPEND manual_files ${manual}.${kind})
    add_custom_command(OUTPUT ${manual}.${kind} COMMAND fascia manual ${kind} > ${manual}.${kind} DEPENDS fascia VERBATIM)
  endforeach()
  set(page ${manual}.man)
  set(page_name fascia.1)
  if(FASCIA_GZIP)
    add_custom_command(OUTPUT ${page}.gz COMMAND ${FASCIA_GZIP} -9nkf ${page} DEPENDS ${page} VERBATIM)
    set(page ${page}.gz)
    set(page_name fascia.1.gz)
  endif()
  add_custom_target(fascia_manual ALL DEPENDS ${manual_files} ${page})
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 RENAME ${page_name} COMPONENT tool)
  install(FILES ${manual}.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME fascia COMPONENT tool)
  install(FILES ${manual}.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _fascia COMPONENT tool)
  install(FILES ${manual}.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d RENAME fascia.fish
    COMPONENT tool)
endif()
include(FasciaPackages)
