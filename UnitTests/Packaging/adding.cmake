include(${CMAKE_CURRENT_LIST_DIR}/Common.cmake)
find_program(NODE NAMES node nodejs REQUIRED)
run(${NODE} ${CMAKE_CURRENT_LIST_DIR}/adding.mjs ${FULCRUM_SOURCE} ${WORK})
# What the recipes add, and what goes through all kinds: the interface, files and recordings.
foreach(file ${WORK}/Fulcrum/Samples/Scenes/Staircase.cpp ${WORK}/Fulcrum/Samples/Scenes/Scenes.cpp
    ${WORK}/Fulcrum/Physics/Joints/ScrewJoint.cpp ${FULCRUM_SOURCE}/Physics/JointInterface.cpp
    ${FULCRUM_SOURCE}/Physics/Recording/CallTable.cpp)
  run(${COMPILER} -std=c++20 -fsyntax-only -Wall -Wextra -Werror -Wno-psabi -I${WORK} -I${FULCRUM_BUILD}/include ${file})
endforeach()
