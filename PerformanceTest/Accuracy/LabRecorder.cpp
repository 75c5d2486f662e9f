#include <Fulcrum/PerformanceTest/Accuracy/LabRecorder.h>

#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Samples/Runner/RecordedShapes.h>

namespace fulcrum::accuracy {
namespace {

constexpr double kFrameSeconds = 1.0 / 60;
constexpr size_t kMostStates = 1'000'000;

Vector3 PlaceFrom(const Position& position, const Position& origin) {
    return Vector3((position - origin).cast<float>());
}

}  // namespace

uint32_t LabRecorder::RecordShape(const ShapePtr& shape) {
    if (const auto known = shapes_.find(shape); known != shapes_.end()) return known->second;
    RecordedShape recorded = RecordedShapeOf(*shape);
    recorded.looks.clear();
    if (shape->IsCompound())
        for (const CompoundShape::ChildSettings& child : static_cast<const CompoundShape&>(*shape).Settings())
            recorded.children.push_back({RecordShape(child.shape), {child.position, child.rotation}});
    const auto index = static_cast<uint32_t>(recording.shapes.size());
    recording.shapes.push_back(std::move(recorded));
    shapes_[shape] = index;
    return index;
}

std::optional<uint32_t> LabRecorder::RecordedBodyOf(BodyId id) const {
    if (id.index >= recorded_.size()) return std::nullopt;
    const uint32_t body = recorded_[id.index];
    return body < ids_.size() && ids_[body] == id ? std::optional(body) : std::nullopt;
}

void LabRecorder::AddNewBodies() {
    const BodyInterface& bodies = system_->Bodies();
    system_->VisitBodies([&](BodyId id) {
        if (RecordedBodyOf(id)) return;
        if (ids_.empty()) recording.origin = bodies.GetPose(id).position;
        if (recorded_.size() <= id.index) recorded_.resize(id.index + 1);
        recorded_[id.index] = static_cast<uint32_t>(ids_.size());
        ids_.push_back(id);
        recording.bodies.push_back({.shape = RecordShape(bodies.GetShape(id)),
                                    .motion = RecordedMotionOf(bodies.GetMotionType(id)),
                                    .mass = bodies.GetMass(id),
                                    .name = {},
                                    .isSensor = bodies.IsSensor(id)});
    });
}

void LabRecorder::AddFrame(const PhysicsSystem& system, double time) {
    if (!system_) system_ = &system;
    if (system_ != &system || hasEnded_ || time < next_ - 1e-6 || stateCount_ > kMostStates) return;
    next_ = time + kFrameSeconds;
    AddNewBodies();
    if (!joints_) joints_.emplace(system, recording.origin, [this](BodyId id) { return RecordedBodyOf(id); });
    const BodyInterface& bodies = system.Bodies();
    states_.clear();
    for (uint32_t body = 0; body < ids_.size(); ++body) {
        const bool isThere = bodies.Exists(ids_[body]);
        if (!isThere && body >= recording.latest.size()) continue;
        RecordedState state = isThere ? RecordedState{} : recording.latest[body];
        state.body = body;
        state.isThere = isThere;
        if (isThere) {
            const Pose pose = bodies.GetPose(ids_[body]);
            state.position = PlaceFrom(pose.position, recording.origin);
            state.rotation = pose.rotation;
            state.velocity = bodies.GetLinearVelocity(ids_[body]);
            state.awake = bodies.IsAwake(ids_[body]);
        }
        states_.push_back(state);
    }
    stateCount_ += states_.size();
    contacts_.clear();
    if (WantsContacts(recording))
        system.VisitContacts([&](const ContactView& contact) {
            for (const ContactView::Point& point : contact.points)
                contacts_.push_back({.point = PlaceFrom(point.position, recording.origin),
                                     .normal = contact.normal,
                                     .separation = point.separation,
                                     .impulse = point.impulse,
                                     .bodyA = recorded_[contact.bodyA.index],
                                     .bodyB = recorded_[contact.bodyB.index]});
        });
    AppendFrame(recording, time, states_, contacts_, joints_->Collect(recording.joints));
}

void LabRecorder::End(const PhysicsSystem& system, double time) {
    if (system_ != &system) return;
    AddFrame(system, time);
    hasEnded_ = true;  // another world may get its address
}

}  // namespace fulcrum::accuracy
