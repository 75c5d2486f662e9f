# What the packaging tests share. CTest calls each with FULCRUM_SOURCE, FULCRUM_BUILD, WORK (a folder to empty and use),
# GENERATOR, COMPILER, LAUNCHER, FLAGS, VERSION.
cmake_policy(VERSION 3.22)

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: exit status ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# configure(SOURCE BUILD FLAGS options...)
function(configure source build flags)
  run(${CMAKE_COMMAND} -S ${source} -B ${build} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} "-DCMAKE_CXX_FLAGS=${FLAGS} ${flags}" ${ARGN})
endfunction()

# What users turn on, and no flag for any processor: the engine itself may be compiled for AVX2.
set(strict "-Wall -Wextra -Wpedantic -Werror")

# The topmost crate rests on two others: its center is at 2.5 m, less the contacts' penetration.
function(expect_pyramid)
  message("${output}")
  if(NOT output MATCHES "crate 6: height 2\\.(49|50) m")
    message(FATAL_ERROR "The pyramid does not stand")
  endif()
endfunction()

# Builds and runs the program in Consumer/ against the package in a prefix.
function(build_consumer prefix build)
  configure(${CMAKE_CURRENT_LIST_DIR}/Consumer ${build} "${strict}" -DCMAKE_PREFIX_PATH=${prefix} ${ARGN})
  run(${CMAKE_COMMAND} --build ${build} --parallel 2)
  run(${build}/consumer)
  expect_pyramid()
endfunction()

# The same, compiled by hand with what pkg-config says.
function(build_with_pkg_config libraries program)
  find_program(PKG_CONFIG pkg-config)
  if(NOT PKG_CONFIG)
    message("pkg-config is not installed: its file is not tried")
    return()
  endif()
  set(ENV{PKG_CONFIG_PATH} ${libraries}/pkgconfig)
  run(${PKG_CONFIG} --modversion fulcrum)
  string(STRIP "${output}" version)
  if(NOT version STREQUAL VERSION)
    message(FATAL_ERROR "pkg-config says that this is version '${version}', not '${VERSION}'")
  endif()
  run(${PKG_CONFIG} --cflags --libs fulcrum)
  separate_arguments(needed UNIX_COMMAND "${output}")
  separate_arguments(flags UNIX_COMMAND "${FLAGS} ${strict}")
  run(${COMPILER} -std=c++20 -O1 ${flags} ${CMAKE_CURRENT_LIST_DIR}/Consumer/main.cpp ${needed} -Wl,-rpath,${libraries}
    -o ${program})
  run(${program})
  expect_pyramid()
endfunction()

function(build_plugin prefix build)
  configure(${CMAKE_CURRENT_LIST_DIR}/Plugin ${build} "${strict}" -DCMAKE_PREFIX_PATH=${prefix} ${ARGN})
  run(${CMAKE_COMMAND} --build ${build} --parallel 2)
  run(${build}/host)
  message("${output}")
  # The floor's top is at 0, the ball's 1 m above.
  string(REGEX MATCHALL "plugin of version ${VERSION}: (1\\.00|0\\.99) m" found "${output}")
  list(LENGTH found count)
  if(NOT count EQUAL 3)
    message(FATAL_ERROR "The plugin does not do what it should")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
