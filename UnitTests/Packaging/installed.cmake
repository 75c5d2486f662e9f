include(${CMAKE_CURRENT_LIST_DIR}/Common.cmake)
run(${CMAKE_COMMAND} --install ${FULCRUM_BUILD} --prefix ${WORK}/prefix)
build_consumer(${WORK}/prefix ${WORK}/build -DCMAKE_BUILD_TYPE=Release)

# With the component that needs other packages, where it was built.
file(GLOB_RECURSE assets ${WORK}/prefix/libFulcrumAssets.*)
if(assets)
  build_consumer(${WORK}/prefix ${WORK}/build-assets -DCMAKE_BUILD_TYPE=Release -DWITH_ASSETS=ON)
  run(${WORK}/build-assets/assets)
  if(NOT output MATCHES "crate: height 0\\.50 m")
    message(FATAL_ERROR "The scene of the text does not stand: ${output}")
  endif()
endif()

# The version is checked: no interface of a later release is promised.
file(WRITE ${WORK}/later/CMakeLists.txt
  "cmake_minimum_required(VERSION 3.22)\nproject(Later LANGUAGES CXX)\nfind_package(Fulcrum 99 REQUIRED)\n")
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${WORK}/later -B ${WORK}/later/build -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${WORK}/prefix
  RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
if(status EQUAL 0)
  message(FATAL_ERROR "find_package(Fulcrum 99) accepted this version")
endif()

file(GLOB_RECURSE pkgconfig_file ${WORK}/prefix/fulcrum.pc)
get_filename_component(folder "${pkgconfig_file}" DIRECTORY)
get_filename_component(libraries "${folder}" DIRECTORY)
build_with_pkg_config(${libraries} ${WORK}/by-hand)
build_plugin(${WORK}/prefix ${WORK}/plugin -DCMAKE_BUILD_TYPE=Debug)
