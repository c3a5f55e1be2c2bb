# viscera_add_glad(TARGET): the OpenGL function table, made by Debian's glad, compiled into TARGET.
#
# One table per context (--mx); --reproducible keeps glad off the network. The loader's two symbols are renamed and the
# header gets a path of its own, so that a host that brings its own glad links and includes beside viscera.
# core_names.h lists the functions of core 3.3, all of which a context must have.
set(viscera_glad_dir ${CMAKE_BINARY_DIR}/glad)

function(viscera_generate_glad)
  set(arguments --reproducible --quiet --api gl:core=4.3
    --extensions GL_KHR_debug,GL_ARB_buffer_storage,GL_ARB_clip_control,GL_NVX_gpu_memory_info
    --out-path ${viscera_glad_dir}/raw c --mx)
  file(MD5 ${CMAKE_CURRENT_FUNCTION_LIST_FILE} recipe)
  set(stamp ${viscera_glad_dir}/stamp)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_FUNCTION_LIST_FILE})
  if(EXISTS ${stamp})
    file(READ ${stamp} made_by)
    if(made_by STREQUAL recipe)
      return()
    endif()
  endif()

  # The C and C++ generator of Debian (python3-glad), not some other glad on the path.
  find_program(VISCERA_GLAD glad HINTS /usr/bin REQUIRED)
  execute_process(COMMAND ${VISCERA_GLAD} ${arguments} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    message(FATAL_ERROR "${VISCERA_GLAD} failed (Debian package python3-glad):\n${said}")
  endif()

  set(out ${viscera_glad_dir}/include/engine/gl/glad)
  foreach(file include/glad/gl.h src/gl.c)
    file(READ ${viscera_glad_dir}/raw/${file} text)
    string(REPLACE "gladLoadGLContextUserPtr" "viscera_load_functions" text "${text}")
    string(REPLACE "gladLoadGLContext" "viscera_load_functions_plain" text "${text}")
    string(REPLACE "<KHR/khrplatform.h>" "\"engine/gl/glad/khrplatform.h\"" text "${text}")
    string(REPLACE "<glad/gl.h>" "\"engine/gl/glad/gl.h\"" text "${text}")
    get_filename_component(name ${file} NAME)
    file(WRITE ${out}/${name} "${text}")
  endforeach()
  file(COPY ${viscera_glad_dir}/raw/include/KHR/khrplatform.h DESTINATION ${out})

  file(STRINGS ${out}/gl.c lines)
  set(names "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^static void glad_gl_load_GL_VERSION_4_0")
      break()
    elseif(line MATCHES "load\\(userptr, (\"gl[A-Za-z0-9_]+\")\\)")
      list(APPEND names ${CMAKE_MATCH_1})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES names)
  list(SORT names COMPARE STRING)
  list(LENGTH names count)
  list(JOIN names ",\n    " names)
  file(WRITE ${out}/core_names.h "#pragma once\n\n#include <array>\n#include <string_view>\n\nnamespace viscera::gl {\n\n"
    "/// The functions of OpenGL 3.3 core, sorted.\n"
    "inline constexpr std::array<std::string_view, ${count}> core_names{\n    ${names}};\n\n}  // namespace viscera::gl\n")
  file(WRITE ${stamp} ${recipe})
endfunction()

function(viscera_add_glad target)
  viscera_generate_glad()
  set(gl_c ${viscera_glad_dir}/include/engine/gl/glad/gl.c)
  target_sources(${target} PRIVATE ${gl_c})
  set_source_files_properties(${gl_c} PROPERTIES COMPILE_OPTIONS "-w;-fvisibility=hidden")
  # Public: effects and hosts that call OpenGL do so through engine/gl/functions.h, which needs the generated header.
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${viscera_glad_dir}/include>)
  if(PROJECT_IS_TOP_LEVEL)
    install(FILES ${viscera_glad_dir}/include/engine/gl/glad/gl.h ${viscera_glad_dir}/include/engine/gl/glad/khrplatform.h
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/viscera/engine/gl/glad)
  endif()
endfunction()
