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

configure(${CMAKE_CURRENT_LIST_DIR}/Headers ${WORK}/build "${strict}"
  -DCMAKE_PREFIX_PATH=${WORK}/prefix -DINCLUDE_FOLDER=${WORK}/prefix/include)
run(${CMAKE_COMMAND} --build ${WORK}/build --parallel 2)
