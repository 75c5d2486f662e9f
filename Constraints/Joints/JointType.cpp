#include <Fulcrum/Constraints/Joints/JointType.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>

namespace fulcrum {

JointDrawing JointType::Drawing() const { return {}; }

}  // namespace fulcrum
