# viscera_embed_shaders(SOURCE_VARIABLE FOLDER folder FUNCTION function)
#
# Puts every shader file under a folder into one generated C++ source that defines
# `std::span<const viscera::EmbeddedShader> function()` (see engine/runtime/embedded_shaders.h), and sets
# SOURCE_VARIABLE to its path, to be added to a target of the same directory. `function` may be qualified:
# "my_effects::shaders". A new, changed or removed file makes the source anew.

# The same file is the script that the build runs.
if(CMAKE_SCRIPT_MODE_FILE)
  if(FUNCTION MATCHES "^(.+)::([^:]+)$")
    set(namespace "${CMAKE_MATCH_1}")
    set(function "${CMAKE_MATCH_2}")
  else()
    set(namespace "")
    set(function "${FUNCTION}")
  endif()
  file(STRINGS "${NAMES}" names)

  # Bytes as escapes: no delimiter can occur in them, and no literal is long.
  string(REPEAT "[^\n]" 64 row)
  set(entries "")
  set(count 0)
  foreach(name IN LISTS names)
    file(READ "${FOLDER}/${name}" bytes HEX)
    string(LENGTH "${bytes}" size)
    math(EXPR size "${size} / 2")
    string(REGEX REPLACE "(${row})" "\\1\n" bytes "${bytes}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" bytes "${bytes}")
    string(REGEX REPLACE "([^\n]+)" "\n     \"\\1\"" bytes "${bytes}")
    string(REPLACE "\"\n\n" "\"\n" bytes "${bytes}")
    string(APPEND entries "    {\"${name}\", std::string_view(${bytes} \"\", ${size})},\n")
    math(EXPR count "${count} + 1")
  endforeach()

  set(text "// Generated from the shader files by cmake/embed_shaders.cmake.\n")
  string(APPEND text "#include <array>\n\n#include \"engine/runtime/embedded_shaders.h\"\n\n")
  string(APPEND text "namespace {\n\nconstexpr std::array<viscera::EmbeddedShader, ${count}> embedded_shader_files{{\n${entries}}};\n\n")
  string(APPEND text "}  // namespace\n\n")
  if(namespace)
    string(APPEND text "namespace ${namespace} {\n")
  endif()
  string(APPEND text "std::span<const ::viscera::EmbeddedShader> ${function}();\n")
  string(APPEND text "std::span<const ::viscera::EmbeddedShader> ${function}() { return ::embedded_shader_files; }\n")
  if(namespace)
    string(APPEND text "}  // namespace ${namespace}\n")
  endif()
  file(WRITE "${OUTPUT}" "${text}")
  return()
endif()

set(viscera_embed_shaders_script "${CMAKE_CURRENT_LIST_FILE}" CACHE INTERNAL "")

function(viscera_embed_shaders source_variable)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "FOLDER;FUNCTION" "")
  if(NOT arg_FOLDER OR NOT arg_FUNCTION)
    message(FATAL_ERROR "viscera_embed_shaders: FOLDER and FUNCTION are needed")
  endif()
  cmake_path(ABSOLUTE_PATH arg_FOLDER BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE)
  string(REPLACE "::" "." stem "${arg_FUNCTION}")
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${stem}.cpp")
  set(list "${CMAKE_CURRENT_BINARY_DIR}/${stem}.txt")

  set(patterns "")
  foreach(extension glsl vert frag geom comp)
    list(APPEND patterns "${arg_FOLDER}/*.${extension}")
  endforeach()
  file(GLOB_RECURSE names RELATIVE "${arg_FOLDER}" CONFIGURE_DEPENDS ${patterns})
  list(SORT names)
  set(files "${names}")
  list(TRANSFORM files PREPEND "${arg_FOLDER}/")
  # The list is an input of its own: without it the removal of a file would go unseen.
  list(JOIN names "\n" lines)
  file(CONFIGURE OUTPUT "${list}" CONTENT "${lines}\n" @ONLY)

  add_custom_command(OUTPUT "${source}"
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${arg_FOLDER} -DNAMES=${list} -DFUNCTION=${arg_FUNCTION} -DOUTPUT=${source}
            -P ${viscera_embed_shaders_script}
    DEPENDS ${files} "${list}" "${viscera_embed_shaders_script}"
    COMMENT "Embedding the shaders of ${arg_FOLDER}" VERBATIM)
  set(${source_variable} "${source}" PARENT_SCOPE)
endfunction()

if(PROJECT_NAME STREQUAL "viscera")
  viscera_embed_shaders(viscera_embedded_shaders FOLDER "${PROJECT_SOURCE_DIR}/glsl"
    FUNCTION viscera::embedded_shader_table)
endif()
