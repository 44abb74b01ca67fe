# Version and commit for scene/version.cpp. Included by the top CMakeLists.txt after the modules; runs itself again as a
# script at each build, so that a new commit recompiles one small file and nothing else.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  add_custom_target(slipmode_version
    COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DSLIPMODE_VERSION=${PROJECT_VERSION}
      -DOUTPUT=${PROJECT_BINARY_DIR}/generated/scene/version.hpp -P ${PROJECT_SOURCE_DIR}/scene/version.cmake
    BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/scene/version.hpp
    COMMENT "" VERBATIM)
  add_dependencies(slipmode_scene slipmode_version)
  target_include_directories(slipmode_scene PRIVATE ${PROJECT_BINARY_DIR}/generated)
  target_compile_definitions(slipmode_scene PRIVATE SLIPMODE_HAS_VERSION_HEADER)
  return()
endif()

set(SLIPMODE_GIT_COMMIT "unknown")
find_program(git git)
if(git AND EXISTS ${SOURCE_DIR}/.git)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env GIT_OPTIONAL_LOCKS=0 ${git} -C ${SOURCE_DIR} describe --always --dirty --abbrev=12 --match=
    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(SLIPMODE_GIT_COMMIT ${described})
  endif()
endif()
configure_file(${SOURCE_DIR}/scene/version.hpp.in ${OUTPUT} @ONLY)  # leaves an unchanged file alone
