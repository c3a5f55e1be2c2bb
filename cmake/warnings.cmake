# One place for how viscera's own targets are compiled.
add_library(viscera_options INTERFACE)
target_compile_options(viscera_options INTERFACE -Wall -Wextra -Wconversion
  $<$<BOOL:${VISCERA_WARNINGS_AS_ERRORS}>:-Werror>)
if(VISCERA_SANITIZE)
  target_compile_options(viscera_options INTERFACE -fsanitize=${VISCERA_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(viscera_options INTERFACE -fsanitize=${VISCERA_SANITIZE})
endif()
