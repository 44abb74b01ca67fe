# cmake -DBUILD_DIR=.. -DCONSUMER_DIR=.. -DSCRATCH_DIR=.. -DCXX=.. -DCXX_FLAGS=..
#   [-DPYTHON=.. -DPYTHON_DIR=..] -P install_and_consume.cmake
# The consumer is compiled without the library's -march: arrays of both must still agree in alignment.

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${SCRATCH_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${SCRATCH_DIR}/prefix)

# One more source for the consumer: every installed header, all of them under slipmode/.
file(GLOB_RECURSE headers RELATIVE ${SCRATCH_DIR}/prefix/include ${SCRATCH_DIR}/prefix/include/*)
set(strays ${headers})
list(FILTER strays EXCLUDE REGEX "^slipmode/[^/]+/.*\\.hpp$")
list(FILTER headers INCLUDE REGEX "\\.hpp$")
if(strays OR NOT headers)
  message(FATAL_ERROR "installed under include/: expected slipmode/<room>/*.hpp only, found '${strays}'")
endif()
list(TRANSFORM headers REPLACE "(.+)" "#include <\\1>\n")
list(JOIN headers "" text)
file(WRITE ${SCRATCH_DIR}/headers.cpp "${text}")

run(${CMAKE_COMMAND} -G Ninja -S ${CONSUMER_DIR} -B ${SCRATCH_DIR}/build -DCMAKE_PREFIX_PATH=${SCRATCH_DIR}/prefix
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=Debug
  -DMORE_SOURCES=${SCRATCH_DIR}/headers.cpp)
run(${CMAKE_COMMAND} --build ${SCRATCH_DIR}/build)
run(${SCRATCH_DIR}/build/consumer)

# The executable with its scenes, manual pages and completion, and the Python package, from the prefix alone.
set(share ${SCRATCH_DIR}/prefix/share)
run(${SCRATCH_DIR}/prefix/bin/slipmode modes ${share}/slipmode/datasets/chain10/scene.toml --quiet)
foreach(file man/man1/slipmode.1 man/man1/slipmode-orbit-find.1 bash-completion/completions/slipmode
    zsh/vendor-completions/_slipmode fish/vendor_completions.d/slipmode.fish)
  if(NOT EXISTS ${share}/${file})
    message(FATAL_ERROR "not installed: share/${file}")
  endif()
endforeach()
if(PYTHON)
  run(${CMAKE_COMMAND} -E env PYTHONPATH=${SCRATCH_DIR}/prefix/${PYTHON_DIR} PYTHONDONTWRITEBYTECODE=1 ${PYTHON} -c
    "import slipmode; assert slipmode.__file__.startswith('${SCRATCH_DIR}'); slipmode.Scene.load('${share}/slipmode/datasets/chain10/scene.toml')")
endif()
file(REMOVE_RECURSE ${SCRATCH_DIR})
