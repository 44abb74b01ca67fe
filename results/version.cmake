# Version and commit for results/version.cpp. Included by the top CMakeLists.txt after the modules; runs itself again as a
# script at each build, so that a new commit recompiles one small file and nothing else.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  add_custom_target(slipmode_version
    COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DSLIPMODE_VERSION=${PROJECT_VERSION}
      -DOUTPUT=${PROJECT_BINARY_DIR}/generated/results/version.hpp -P ${PROJECT_SOURCE_DIR}/results/version.cmake
    BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/results/version.hpp
    COMMENT "" VERBATIM)
  add_dependencies(slipmode_results slipmode_version)
  target_include_directories(slipmode_results PRIVATE ${PROJECT_BINARY_DIR}/generated)
  target_compile_definitions(slipmode_results PRIVATE SLIPMODE_HAS_VERSION_HEADER)
  return()
endif()

# Without git: the commit that `git archive` wrote here (see .gitattributes), else the version.
set(SLIPMODE_GIT_COMMIT "$Format:%H$")
if(SLIPMODE_GIT_COMMIT MATCHES "Format")
  set(SLIPMODE_GIT_COMMIT "v${SLIPMODE_VERSION}")
else()
  string(SUBSTRING ${SLIPMODE_GIT_COMMIT} 0 12 SLIPMODE_GIT_COMMIT)
endif()
find_program(git git)
if(git AND EXISTS ${SOURCE_DIR}/.git)
  # A checkout of another user's (built with sudo) is as good as one's own to read from.
  execute_process(COMMAND ${CMAKE_COMMAND} -E env GIT_OPTIONAL_LOCKS=0 ${git} -c safe.directory=* -C ${SOURCE_DIR}
      describe --always --dirty --abbrev=12 --match=
    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(SLIPMODE_GIT_COMMIT ${described})
  endif()
endif()
configure_file(${SOURCE_DIR}/results/version.hpp.in ${OUTPUT} @ONLY)  # leaves an unchanged file alone
