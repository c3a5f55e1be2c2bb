# One place for how viscera's own targets are compiled.
add_library(viscera_options INTERFACE)
# Designated initialisers leave members at their defaults on purpose.
target_compile_options(viscera_options INTERFACE -Wall -Wextra -Wconversion -Wno-missing-field-initializers
  $<$<BOOL:${VISCERA_WARNINGS_AS_ERRORS}>:-Werror>)
# GCC 12 sees overlapping copies in `"text" + std::string` where there are none (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(viscera_options INTERFACE -Wno-restrict)
endif()
if(VISCERA_SANITIZE)
  target_compile_options(viscera_options INTERFACE -fsanitize=${VISCERA_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(viscera_options INTERFACE -fsanitize=${VISCERA_SANITIZE})
endif()
