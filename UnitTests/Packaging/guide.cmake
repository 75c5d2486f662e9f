include(${CMAKE_CURRENT_LIST_DIR}/Common.cmake)
find_program(NODE NAMES node nodejs REQUIRED)
run(${NODE} ${CMAKE_CURRENT_LIST_DIR}/snippets.mjs ${FULCRUM_SOURCE} ${WORK}/snippets)

# The program of README.md is the one that the other tests compile.
file(READ ${WORK}/snippets/readme.cpp readme)
file(READ ${CMAKE_CURRENT_LIST_DIR}/Consumer/main.cpp consumer)
if(NOT readme STREQUAL consumer)
  message(FATAL_ERROR "README.md has another program than UnitTests/Packaging/Consumer/main.cpp")
endif()

run(${CMAKE_COMMAND} --install ${FULCRUM_BUILD} --prefix ${WORK}/prefix)
configure(${CMAKE_CURRENT_LIST_DIR}/Guide ${WORK}/build "${strict}" -DCMAKE_PREFIX_PATH=${WORK}/prefix
  -DSNIPPETS=${WORK}/snippets)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/guide)
file(READ ${WORK}/snippets/expected.txt expected)
if(NOT output STREQUAL expected)
  file(WRITE ${WORK}/snippets/printed.txt "${output}")
  execute_process(COMMAND diff ${WORK}/snippets/expected.txt ${WORK}/snippets/printed.txt OUTPUT_VARIABLE difference)
  message(FATAL_ERROR "Docs/Guide.md says (<), its snippets print (>):\n${difference}")
endif()
