# cmake -DBUILD_DIR=.. -DCONSUMER_DIR=.. -DSCRATCH_DIR=.. -DCXX=.. -DCXX_FLAGS=.. -P install_and_consume.cmake
# The consumer is compiled without the library's -march: arrays of both must still agree in alignment.

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${SCRATCH_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${SCRATCH_DIR}/prefix)
run(${CMAKE_COMMAND} -G Ninja -S ${CONSUMER_DIR} -B ${SCRATCH_DIR}/build -DCMAKE_PREFIX_PATH=${SCRATCH_DIR}/prefix
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS} -DCMAKE_BUILD_TYPE=Debug)
run(${CMAKE_COMMAND} --build ${SCRATCH_DIR}/build)
run(${SCRATCH_DIR}/build/consumer)
file(REMOVE_RECURSE ${SCRATCH_DIR})
