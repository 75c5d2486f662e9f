# Installs the library so that find_package(Fulcrum 0.2) and pkg-config find it: headers, libraries, package files, license.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Fulcrum)
get_target_property(library_type FulcrumPhysics TYPE)

install(TARGETS FulcrumMath FulcrumJobs FulcrumCollision FulcrumConstraints FulcrumPhysics
  EXPORT FulcrumTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT FulcrumTargets NAMESPACE Fulcrum:: DESTINATION ${package_folder})
# A component of its own: whoever does not ask for it needs none of its packages.
set(component_headers "")
if(TARGET FulcrumAssets)
  install(TARGETS FulcrumAssets EXPORT FulcrumAssetsTargets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT FulcrumAssetsTargets NAMESPACE Fulcrum:: DESTINATION ${package_folder})
  install(FILES ${PROJECT_SOURCE_DIR}/Assets/scene.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/fulcrum)
  set(component_headers Assets/SceneFile.h Assets/RagdollJson.h Assets/Meshes/MeshImport.h)
endif()

# The headers are looked for when they are installed: whatever has been included since the build was configured is among them.
install(CODE "
  set(FULCRUM_SOURCE \"${PROJECT_SOURCE_DIR}\")
  set(FULCRUM_COMPONENT_HEADERS \"${component_headers}\")
  set(FULCRUM_HEADERS \"${CMAKE_INSTALL_INCLUDEDIR}/Fulcrum\")
  include(\"${PROJECT_SOURCE_DIR}/cmake/InstallHeaders.cmake\")")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(cmake/FulcrumConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/FulcrumConfig.cmake
  INSTALL_DESTINATION ${package_folder})
# Before 1.0, each minor version may change the interface.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/FulcrumConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
    ${CMAKE_CURRENT_BINARY_DIR}/FulcrumConfig.cmake
    ${CMAKE_CURRENT_BINARY_DIR}/FulcrumConfigVersion.cmake
  DESTINATION ${package_folder})

# Whoever links the static libraries needs what these need; a shared one brings libccd itself.
if(NOT FULCRUM_LIBCCD)
  set(pkgconfig_requires "")
  set(pkgconfig_requires_private "")
elseif(library_type STREQUAL "STATIC_LIBRARY")
  set(pkgconfig_requires "ccd")
  set(pkgconfig_requires_private "")
else()
  set(pkgconfig_requires "")
  set(pkgconfig_requires_private "ccd")
endif()
# Relative to the file itself, so that the prefix may be chosen when it is installed; absolute folders stay what they are.
file(RELATIVE_PATH pkgconfig_up /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
foreach(folder LIBDIR INCLUDEDIR)
  if(IS_ABSOLUTE ${CMAKE_INSTALL_${folder}})
    set(pkgconfig_${folder} ${CMAKE_INSTALL_${folder}})
  else()
    set(pkgconfig_${folder} "\${prefix}/${CMAKE_INSTALL_${folder}}")
  endif()
endforeach()
if(IS_ABSOLUTE ${CMAKE_INSTALL_LIBDIR})
  set(pkgconfig_prefix ${CMAKE_INSTALL_PREFIX})
else()
  set(pkgconfig_prefix "\${pcfiledir}/${pkgconfig_up}")
endif()
configure_file(cmake/fulcrum.pc.in ${CMAKE_CURRENT_BINARY_DIR}/fulcrum.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fulcrum.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
