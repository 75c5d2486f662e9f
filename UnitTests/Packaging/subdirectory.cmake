include(${CMAKE_CURRENT_LIST_DIR}/Common.cmake)
# Without optimization, and by Clang where it is there, in a third of GCC's time: the whole library is compiled again.
# Flags of this build may be its compiler's own.
find_program(CLANG clang++)
if(CLANG AND NOT FLAGS)
  set(COMPILER ${CLANG})
endif()
configure(${CMAKE_CURRENT_LIST_DIR}/Consumer ${WORK}/build "${strict}" -DFULCRUM_SOURCE=${FULCRUM_SOURCE}
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DFULCRUM_UNITY=ON -DBUILD_SHARED_LIBS=ON -DFULCRUM_INSTALL=ON
  -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_INSTALL_INCLUDEDIR=headers)

# Whoever adds Fulcrum gets the library alone.
run(${CMAKE_COMMAND} --build ${WORK}/build --target help)
if(output MATCHES "FulcrumTests|FulcrumScenes|fulcrum-runner|fulcrum-bench|FulcrumKernels")
  message(FATAL_ERROR "Programs beside the library are among the targets:\n${output}")
endif()
run(${CMAKE_COMMAND} --build ${WORK}/build --parallel 2)
run(${WORK}/build/consumer)
expect_pyramid()

run(${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/prefix)
file(GLOB archives ${WORK}/prefix/lib/*.a)
file(GLOB libraries ${WORK}/prefix/lib/libFulcrumPhysics.so*)
if(archives OR NOT libraries)
  message(FATAL_ERROR "BUILD_SHARED_LIBS was not obeyed: ${archives} ${libraries}")
endif()
if(EXISTS ${WORK}/prefix/include OR NOT EXISTS ${WORK}/prefix/headers/Fulcrum/Fulcrum.h)
  message(FATAL_ERROR "CMAKE_INSTALL_INCLUDEDIR was not obeyed")
endif()
# From where it is installed alone.
file(RENAME ${WORK}/build ${WORK}/moved)
set(ENV{LD_LIBRARY_PATH} "")
build_consumer(${WORK}/prefix ${WORK}/installed -DCMAKE_BUILD_TYPE=Debug)
build_with_pkg_config(${WORK}/prefix/lib ${WORK}/by-hand)
build_plugin(${WORK}/prefix ${WORK}/plugin -DCMAKE_BUILD_TYPE=Debug)
