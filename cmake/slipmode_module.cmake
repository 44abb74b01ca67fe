# One object library per folder, so that a folder can be built and tested alone; all are gathered into `slipmode`.

include(CheckCXXCompilerFlag)

add_library(slipmode_flags INTERFACE)
target_compile_options(slipmode_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 warns about the undefined operands in its own AVX-512 intrinsics (GCC bug 105593), which Eigen uses.
  target_compile_options(slipmode_flags INTERFACE -Wno-maybe-uninitialized -Wno-uninitialized)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC looks for garbage from 128 MB on, again and again in sources that take 1 GB: a tenth of its time.
  target_compile_options(slipmode_flags INTERFACE --param=ggc-min-heapsize=1000000)
endif()
if(SLIPMODE_WERROR)
  target_compile_options(slipmode_flags INTERFACE -Werror)
endif()
if(SLIPMODE_ARCH AND NOT SLIPMODE_SANITIZE)
  string(MAKE_C_IDENTIFIER "SLIPMODE_ACCEPTS_${SLIPMODE_ARCH}" accepted)
  check_cxx_compiler_flag(-march=${SLIPMODE_ARCH} ${accepted})
  if(NOT ${accepted})
    message(FATAL_ERROR "SLIPMODE_ARCH: ${CMAKE_CXX_COMPILER} takes no -march=${SLIPMODE_ARCH} "
      "(known to work: x86-64-v2, x86-64-v3, x86-64-v4, native, or empty for the compiler's default)")
  endif()
  target_compile_options(slipmode_flags INTERFACE -march=${SLIPMODE_ARCH})
endif()
# GCC's own default; clang would fuse multiplications and additions within one expression only, and the hot loops, written
# in small inlined functions, would lose most of their fused operations. README.md says what it means for results.
target_compile_options(slipmode_flags INTERFACE -ffp-contract=fast)
if(SLIPMODE_SANITIZE)
  # Checks of each pointer before each use double the time to compile, of kernels tenfold; null and stray pointers the
  # address sanitizer finds. Eigen's blocks of empty matrices are offsets from null (pointer-overflow).
  set(SLIPMODE_SANITIZER_FLAGS -fsanitize=address,undefined
    -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_options(slipmode_flags INTERFACE ${SLIPMODE_SANITIZER_FLAGS})
  target_link_options(slipmode_flags INTERFACE -fsanitize=address,undefined)
endif()

# What only reads, writes and reports is compiled faster: -O1 in release builds, -O0 under the sanitizers.
add_library(slipmode_light INTERFACE)
target_compile_options(slipmode_light INTERFACE $<$<CONFIG:Release>:-O1> $<$<BOOL:${SLIPMODE_SANITIZE}>:-O0>)
set(SLIPMODE_LIGHT_MODULES scene trade results figures studies report)
# The time of these goes into dynamics' loops and core's decompositions. Their own code is compiled at -O1 in two thirds of
# the time; no run measured took more than 2 % longer.
set(SLIPMODE_COLD_MODULES fem pod rom orbits)

# Eigen's alignment, of what is on the heap and of arrays of fixed size, must be the same in the library and in whoever
# links it, whatever -march each uses. Blocks of its products must not follow the processor's caches: sums would round
# otherwise on each.
set(SLIPMODE_PUBLIC_DEFINITIONS EIGEN_MAX_ALIGN_BYTES=64 EIGEN_MAX_STATIC_ALIGN_BYTES=16 EIGEN_NO_CPUID)

# Headers are included as they are installed, <slipmode/fem/structure.hpp>; those in internal/ folders, which are not,
# as "fem/internal/eigensolvers.hpp".
set(SLIPMODE_BUILD_INCLUDE ${PROJECT_BINARY_DIR}/include)
file(MAKE_DIRECTORY ${SLIPMODE_BUILD_INCLUDE})
file(CREATE_LINK ${PROJECT_SOURCE_DIR} ${SLIPMODE_BUILD_INCLUDE}/slipmode SYMBOLIC)

# diagnostics/series/internal/fourier_*.cpp: one of the two.
set(other_fourier fftw)
set(fourier_library)
if(SLIPMODE_FFTW)
  set(other_fourier kiss)
  set(fourier_library slipmode::fftw3)
endif()

function(slipmode_module name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${name}/*.cpp)
  list(FILTER sources EXCLUDE REGEX /kernels/)
  list(FILTER sources EXCLUDE REGEX /fourier_${other_fourier}\.cpp$)
  add_library(slipmode_${name} OBJECT ${sources})
  target_include_directories(slipmode_${name} PUBLIC ${SLIPMODE_BUILD_INCLUDE} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(slipmode_${name} PUBLIC ${SLIPMODE_PUBLIC_DEFINITIONS})
  target_link_libraries(slipmode_${name} PUBLIC Eigen3::Eigen PRIVATE slipmode_flags Spectra::Spectra fmt::fmt
    tomlplusplus::tomlplusplus nlohmann_json::nlohmann_json ${fourier_library} slipmode::hdf5 ZLIB::ZLIB
    Threads::Threads)
  if(name IN_LIST SLIPMODE_LIGHT_MODULES)
    target_link_libraries(slipmode_${name} PRIVATE slipmode_light)
  endif()
  if(name IN_LIST SLIPMODE_COLD_MODULES)
    target_compile_options(slipmode_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  if(name STREQUAL dynamics)
    # GCC took half as long again for all of its sources in one piece; others measured took less.
    set_target_properties(slipmode_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 12)
  endif()
  target_sources(slipmode PRIVATE $<TARGET_OBJECTS:slipmode_${name}>)
endfunction()

function(slipmode_configure_library)
  target_include_directories(slipmode PUBLIC $<BUILD_INTERFACE:${SLIPMODE_BUILD_INCLUDE}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_definitions(slipmode PUBLIC ${SLIPMODE_PUBLIC_DEFINITIONS})
  target_link_libraries(slipmode PUBLIC Eigen3::Eigen PRIVATE fmt::fmt tomlplusplus::tomlplusplus LAPACK::LAPACK
    ${fourier_library} slipmode::hdf5 ZLIB::ZLIB Threads::Threads)
  target_compile_features(slipmode PUBLIC cxx_std_20)
  set_target_properties(slipmode PROPERTIES LINKER_LANGUAGE CXX)
endfunction()

# An executable of this project whose own sources are light. Of a template or inline function compiled in several places
# the linker keeps the first it meets: the library comes first, whole and its numerical folders ahead, so that its hot loops
# never call a copy made at -O1.
function(slipmode_light_executable name)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE slipmode slipmode_flags slipmode_light)
  target_link_options(${name} PRIVATE -Wl,--whole-archive $<TARGET_FILE:slipmode> -Wl,--no-whole-archive)
endfunction()
