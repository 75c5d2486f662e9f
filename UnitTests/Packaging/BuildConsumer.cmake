# Builds and runs the program in Consumer/ as a user would, outside the tree. CTest calls it with
#   WAY        `installed` (find_package on a fresh installation of FULCRUM_BUILD) or `subdirectory` (FetchContent)
#   FULCRUM_SOURCE, FULCRUM_BUILD, WORK (a folder to empty and use), GENERATOR, COMPILER, FLAGS
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: exit status ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(configure ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/Consumer -G ${GENERATOR}
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS})

file(REMOVE_RECURSE ${WORK})
if(WAY STREQUAL "installed")
  run(${CMAKE_COMMAND} --install ${FULCRUM_BUILD} --prefix ${WORK}/prefix)
  run(${configure} -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_BUILD_TYPE=Release)

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
else()
  # Without optimisation: the whole library is compiled again.
  run(${configure} -B ${WORK}/build -DFULCRUM_SOURCE=${FULCRUM_SOURCE} -DCMAKE_BUILD_TYPE=Debug)

  # Whoever adds Fulcrum gets the library alone.
  run(${CMAKE_COMMAND} --build ${WORK}/build --target help)
  if(output MATCHES "FulcrumTests|FulcrumScenes|fulcrum-runner|fulcrum-bench|FulcrumKernels")
    message(FATAL_ERROR "Programs beside the library are among the targets:\n${output}")
  endif()
endif()

run(${CMAKE_COMMAND} --build ${WORK}/build --parallel 2)
run(${WORK}/build/consumer)
message("${output}")

# The topmost crate rests on two others: its centre is 2.5 m up, less what the contacts give way.
if(NOT output MATCHES "crate 6: height 2\\.(49|50) m")
  message(FATAL_ERROR "The pyramid does not stand")
endif()
