# Installs the library so that find_package(Fulcrum 0.1) finds it: headers, archives, package files.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Fulcrum)

install(TARGETS FulcrumMath FulcrumJobs FulcrumCollision FulcrumConstraints FulcrumPhysics
  EXPORT FulcrumTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY Math Jobs Collision Constraints Physics
  DESTINATION include/Fulcrum
  FILES_MATCHING PATTERN "*.h")
install(EXPORT FulcrumTargets NAMESPACE Fulcrum:: DESTINATION ${package_folder})

configure_package_config_file(cmake/FulcrumConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/FulcrumConfig.cmake
  INSTALL_DESTINATION ${package_folder})
# Before 1.0, each minor version may change the interface.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/FulcrumConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
    ${CMAKE_CURRENT_BINARY_DIR}/FulcrumConfig.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/FulcrumConfigVersion.cmake
  DESTINATION ${package_folder})
