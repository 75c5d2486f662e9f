#include <Fulcrum/Constraints/Joints/JointType.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>

#include <algorithm>
#include <vector>

namespace fulcrum {

JointDrawing JointType::Drawing() const { return {}; }

void JointType::RowsAt(const JointPose& pose, JointRowList& rows) const {
    auto& self = const_cast<JointType&>(*this);  // none is created const
    const std::span<double> state = self.State();
    std::vector<double> before(state.begin(), state.end());
    self.CollectRows(pose, rows);
    if (!before.empty()) std::copy(before.begin(), before.end(), state.begin());
}

}  // namespace fulcrum
