# slipmode::sundials, the CVODE that Debian's libsundials-dev brings, where it is: a peer of benchmarks and tests.
# Libraries are looked for by name: the package file of libsundials-dev asks for MPI, OpenMP and more, unused here.
find_path(SUNDIALS_INCLUDE_DIR cvode/cvode.h)
set(sundials)
foreach(part cvode nvecserial sunmatrixband sunmatrixdense sunlinsolband sunlinsoldense sunnonlinsolfixedpoint)
  find_library(SUNDIALS_${part}_LIBRARY sundials_${part})
  mark_as_advanced(SUNDIALS_${part}_LIBRARY)
  list(APPEND sundials ${SUNDIALS_${part}_LIBRARY})
endforeach()
mark_as_advanced(SUNDIALS_INCLUDE_DIR)
if(SUNDIALS_INCLUDE_DIR AND NOT sundials MATCHES "NOTFOUND")
  add_library(slipmode::sundials INTERFACE IMPORTED)
  set_target_properties(slipmode::sundials PROPERTIES INTERFACE_LINK_LIBRARIES "${sundials}"
    INTERFACE_INCLUDE_DIRECTORIES ${SUNDIALS_INCLUDE_DIR})
endif()
