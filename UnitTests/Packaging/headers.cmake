include(${CMAKE_CURRENT_LIST_DIR}/Common.cmake)
run(${CMAKE_COMMAND} --install ${FULCRUM_BUILD} --prefix ${WORK}/prefix)

file(GLOB_RECURSE license ${WORK}/prefix/LICENSE)
if(NOT license)
  message(FATAL_ERROR "The license is not installed")
endif()
set(folder ${WORK}/prefix/include/Fulcrum)
foreach(header Fulcrum.h Version.h Physics/PhysicsSystem.h Collision/Shapes/Primitives.h Math/Vector.h)
  if(NOT EXISTS ${folder}/${header})
    message(FATAL_ERROR "${header} is not installed")
  endif()
endforeach()
# The engine's own: its stages, its state, its kernels.
foreach(header Physics/World/WorldState.h Physics/Stages/Stages.h Constraints/Joints/JointBatch.h Collision/NarrowPhase/Epa.h)
  if(EXISTS ${folder}/${header})
    message(FATAL_ERROR "${header} is no public header, but it is installed")
  endif()
endforeach()

# Slow to compile, and programs include all of this: <cmath> alone takes a tenth of the time of Fulcrum.h.
file(GLOB_RECURSE headers ${folder}/*.h)
foreach(header IN LISTS headers)
  file(STRINGS ${header} slow
    REGEX "#include <(Eigen/.*|algorithm|atomic|chrono|cmath|functional|map|mutex|sstream|iostream|thread|unordered_map)>")
  if(slow)
    message(FATAL_ERROR "${header}: ${slow}")
  endif()
endforeach()

# Each begins with what stops a compiler of an earlier C++ at once, by itself or by what it includes.
foreach(header IN LISTS headers)
  file(STRINGS ${header} included REGEX "#include <Fulcrum/")
  if(NOT included AND NOT header MATCHES "/(Version|NeedsCpp20)\\.h$")
    message(FATAL_ERROR "${header} includes no other header, and so needs <Fulcrum/Math/NeedsCpp20.h>")
  endif()
endforeach()
file(WRITE ${WORK}/cpp17.cpp "#include <Fulcrum/Fulcrum.h>\n")
execute_process(COMMAND ${COMPILER} -std=c++17 -fsyntax-only -I${WORK}/prefix/include ${WORK}/cpp17.cpp
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
string(REGEX MATCHALL "error: " errors "${output}")
list(LENGTH errors count)
if(status EQUAL 0 OR NOT count EQUAL 1 OR NOT output MATCHES "error: [^\n]*C\\+\\+20")
  message(FATAL_ERROR "C++17 gives ${count} errors in place of one that says C++20:\n${output}")
endif()

configure(${CMAKE_CURRENT_LIST_DIR}/Headers ${WORK}/build "${strict}"
  -DCMAKE_PREFIX_PATH=${WORK}/prefix -DINCLUDE_FOLDER=${WORK}/prefix/include)
run(${CMAKE_COMMAND} --build ${WORK}/build --parallel 2)
