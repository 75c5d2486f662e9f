include(${CMAKE_CURRENT_LIST_DIR}/Common.cmake)

# How the engine's and the program's own sources would be compiled: as flags_of_engine and flags_of_program.
function(configure_consumer name flags)
  configure(${CMAKE_CURRENT_LIST_DIR}/Consumer ${WORK}/${name} "${flags}" -DFULCRUM_SOURCE=${FULCRUM_SOURCE}
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DFULCRUM_SIMD=SSE2 ${ARGN})
  file(STRINGS ${WORK}/${name}/compile_commands.json engine REGEX "\"command\".*Physics/PhysicsSystem\\.cpp")
  file(STRINGS ${WORK}/${name}/compile_commands.json program REGEX "\"command\".*Consumer/main\\.cpp")
  if(NOT engine OR NOT program)
    message(FATAL_ERROR "${name}: no command compiles the engine and the program")
  endif()
  set(engine "${engine}" PARENT_SCOPE)
  set(program "${program}" PARENT_SCOPE)
endfunction()

macro(expect command pattern)
  if(NOT ${command} MATCHES "${pattern}")
    message(FATAL_ERROR "Among the flags of the ${command} there is no ${pattern}: ${${command}}")
  endif()
endmacro()
macro(expect_no command pattern)
  if(${command} MATCHES "${pattern}")
    message(FATAL_ERROR "Among the flags of the ${command} there is ${pattern}: ${${command}}")
  endif()
endmacro()

# Nothing was chosen: the engine is optimized, the program is as its own build has it.
configure_consumer(nothing "")
expect(engine " -O3 -DNDEBUG ")
expect(engine " -fPIC ")
expect_no(program " -O")
# What was chosen stays.
configure_consumer(debug "" -DCMAKE_BUILD_TYPE=Debug)
expect(engine " -g ")
expect_no(engine " -O")
configure_consumer(flags "-O1")
expect(engine " -O1 ")
expect_no(engine " -O3")
configure_consumer(positioned "" -DCMAKE_POSITION_INDEPENDENT_CODE=OFF)
expect_no(engine " -fPIC ")
find_program(NINJA ninja)
if(NINJA)
  set(GENERATOR "Ninja Multi-Config")
  configure_consumer(multi "" -DCMAKE_DEFAULT_BUILD_TYPE=Debug)
  expect(engine "INTDIR=[^ ]*Debug[^ ]* +-I[^ ]+ +-isystem +[^ ]+ +-g ")
endif()

# Tests of the engine without samples ask for none of the packages that samples and benchmarks need.
configure(${FULCRUM_SOURCE} ${WORK}/tests "" -DFULCRUM_BUILD_TESTS=ON -DFULCRUM_BUILD_SAMPLES=OFF -DFULCRUM_BUILD_BENCHMARKS=OFF
  -DCMAKE_DISABLE_FIND_PACKAGE_assimp=ON -DCMAKE_DISABLE_FIND_PACKAGE_ZLIB=ON -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON
  -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON -DFULCRUM_NPM=FULCRUM_NPM-NOTFOUND)
run(${CMAKE_COMMAND} --build ${WORK}/tests --target help)
if(output MATCHES "FulcrumViewer|FulcrumRunner")
  message(FATAL_ERROR "Tests without samples build the viewer or the runner:\n${output}")
endif()
