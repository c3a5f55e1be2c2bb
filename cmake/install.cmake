# What `cmake --install` puts where, and the package that find_package(viscera) reads:
#   include/viscera/{engine,effects}/...   include paths are those of the source tree: "engine/runtime/renderer.h"
#   lib/lib{viscera_core,viscera_engine,viscera_effects}.a, lib/cmake/viscera/
#   bin/viscera
#   share/viscera/{glsl,assets}            shaders to reload from, scenes with all that they name
include(CMakePackageConfigHelpers)

set(viscera_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/viscera)
set(viscera_data_dir ${CMAKE_INSTALL_DATADIR}/viscera)

install(TARGETS viscera_core viscera_engine viscera_effects EXPORT viscera-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT viscera-targets NAMESPACE viscera:: DESTINATION ${viscera_package_dir})

# The generated OpenGL header is installed by cmake/glad.cmake, which knows where it is.
foreach(room engine effects)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/viscera
    FILES_MATCHING PATTERN "*.h")
endforeach()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/viscera-config.cmake.in
  ${PROJECT_BINARY_DIR}/viscera-config.cmake INSTALL_DESTINATION ${viscera_package_dir} PATH_VARS viscera_data_dir)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/viscera-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/viscera-config.cmake ${PROJECT_BINARY_DIR}/viscera-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/embed_shaders.cmake DESTINATION ${viscera_package_dir})

install(DIRECTORY ${PROJECT_SOURCE_DIR}/glsl DESTINATION ${viscera_data_dir})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets DESTINATION ${viscera_data_dir}
  PATTERN "generate" EXCLUDE PATTERN "CMakeLists.txt" EXCLUDE)
if(TARGET viscera_app)
  install(TARGETS viscera_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
