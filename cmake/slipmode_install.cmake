# `cmake --install`: the library, its public headers under include/slipmode/<folder>/, the package files behind
# find_package(slipmode), the scenes that ship and the MATLAB package; from cli/ the executable with its manual pages and
# shell completion, from python/ the Python package.

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/slipmode)

install(TARGETS slipmode EXPORT slipmodeTargets ARCHIVE)
foreach(module ${SLIPMODE_MODULES})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${module} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/slipmode
    FILES_MATCHING PATTERN "*.hpp" PATTERN internal EXCLUDE PATTERN page EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/datasets ${PROJECT_SOURCE_DIR}/matlab DESTINATION ${CMAKE_INSTALL_DATADIR}/slipmode)
install(EXPORT slipmodeTargets NAMESPACE slipmode:: DESTINATION ${package_dir})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/slipmodeConfig.cmake.in
  ${PROJECT_BINARY_DIR}/slipmodeConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/slipmodeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/slipmodeConfig.cmake ${PROJECT_BINARY_DIR}/slipmodeConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/slipmode_libraries.cmake DESTINATION ${package_dir})
