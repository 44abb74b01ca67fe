# Libraries without a CMake package of their own on Debian, as imported targets. Used by the build and, installed beside
# slipmodeConfig.cmake, by whoever links slipmode.

function(slipmode_import name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "HEADER" "NAMES;PATH_SUFFIXES")
  if(TARGET slipmode::${name})
    return()
  endif()
  string(TOUPPER SLIPMODE_${name} prefix)
  find_library(${prefix}_LIBRARY NAMES ${arg_NAMES} PATH_SUFFIXES ${arg_PATH_SUFFIXES} REQUIRED)
  find_path(${prefix}_INCLUDE_DIR NAMES ${arg_HEADER} PATH_SUFFIXES ${arg_PATH_SUFFIXES} REQUIRED)
  mark_as_advanced(${prefix}_LIBRARY ${prefix}_INCLUDE_DIR)
  add_library(slipmode::${name} UNKNOWN IMPORTED)
  set_target_properties(slipmode::${name} PROPERTIES IMPORTED_LOCATION ${${prefix}_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${${prefix}_INCLUDE_DIR})
endfunction()

if(SLIPMODE_FFTW)
  slipmode_import(fftw3 NAMES fftw3 HEADER fftw3.h)
endif()
# The serial library: an MPI one may stand beside it under the plain name.
slipmode_import(hdf5 NAMES hdf5_serial hdf5 HEADER hdf5.h PATH_SUFFIXES hdf5/serial)
