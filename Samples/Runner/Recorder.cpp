#include <Fulcrum/Samples/Runner/Recorder.h>

#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Samples/Runner/RecordedShapes.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace fulcrum {
namespace {

constexpr double kFramesPerSecond = 60;
// Each is about 10 bytes of a page.
constexpr double kMostStates = 1.2e6;

// Of all edits of height fields; each is about 40 bytes of a page. The last is recorded in any case, so that a field
// may look older than it is, but the end of a recording is right.
constexpr size_t kMostEditedTriangles = 500'000;

constexpr uint8_t kGone = 2;  // of settled_: removed, and recorded as such

// Changes with every edit of a height field; 0 for all else.
uint64_t FingerprintOf(const Shape& shape) {
    if (shape.Type() != ShapeType::HeightField) return 0;
    const HeightField& field = static_cast<const HeightField&>(shape);
    uint64_t hash = 0xCBF29CE484222325ull;  // FNV-1a, 64 bits, by words
    const auto put = [&](uint32_t word) { hash = (hash ^ word) * 0x100000001B3ull; };
    for (uint32_t z = 0; z <= field.CellCountZ(); ++z)
        for (uint32_t x = 0; x <= field.CellCountX(); ++x) {
            put(std::bit_cast<uint32_t>(field.Height(x, z)));
            if (x < field.CellCountX() && z < field.CellCountZ()) put(field.Cell(x, z));
        }
    return hash;
}

}  // namespace

Recorder::Recorder(SceneWorld& world, int steps, double dt) : world_(world), steps_(steps) {
    world.Draw().TurnOn();
    recording.title = world.Definition().name;
    recording.description = world.Definition().description;
    double moving = 0;
    world.System().VisitBodies([&](BodyId id) {
        if (world.Bodies().GetMotionType(id) == MotionType::Dynamic && world.Bodies().IsAwake(id)) ++moving;
    });
    NoteView();
    AddNewBodies();
    joints_.emplace(world.System(), recording.origin, [this](BodyId id) { return RecordedBodyOf(id); });
    const double forRate = 1 / (kFramesPerSecond * dt), forSize = moving * steps / kMostStates;
    interval_ = static_cast<int>(std::max({1.0, std::round(forRate), std::ceil(forSize)}));
    AddFrame();
}

void Recorder::AfterStep() {
    NoteStep();
    const int step = world_.StepCount();
    if (step % interval_ == 0 || step == steps_) AddFrame();
}

const RecordedFrame& Recorder::Now() {
    isLive_ = true;
    recording.frames.clear();
    AddFrame();
    return recording.frames.back();
}

uint32_t Recorder::RecordShape(const ShapePtr& shape, BodyId user) {
    const uint64_t fingerprint = FingerprintOf(*shape);
    const auto known = shapes_.find(shape.get());
    if (known != shapes_.end() && known->second.fingerprint == fingerprint) return known->second.index;
    RecordedShape recorded;
    if (const auto* compound = dynamic_cast<const CompoundShape*>(shape.get())) {
        recorded.kind = RecordedShapeKind::Compound;
        for (const CompoundShape::ChildSettings& child : compound->Settings())
            recorded.children.push_back({RecordShape(child.shape, user), {child.position, child.rotation}});
    } else {
        recorded = RecordedShapeOf(*shape);
        PutLooks(user, recorded);
    }
    const uint32_t index = static_cast<uint32_t>(recording.shapes.size());
    recording.shapes.push_back(std::move(recorded));
    shapes_[shape.get()] = {shape, index, fingerprint};
    return index;
}

// Adds bodies that are new; for mutable compounds their children.
void Recorder::AddNewBodies() {
    const BodyInterface& bodies = world_.Bodies();
    world_.System().VisitBodies([&](BodyId id) {
        const MutableCompound* compound = bodies.GetChildren(id);
        if (!compound) {
            if (!RecordedBodyOf(id)) AddRecordedBody(id, {}, bodies.GetShape(id));
            return;
        }
        for (uint32_t i = 0; i < compound->Children().size(); ++i)
            if (const ShapePtr& shape = compound->Children()[i].shape)
                if (!recordedChildren_.contains({id, compound->IdOf(i)})) AddRecordedBody(id, compound->IdOf(i), shape);
    });
}

void Recorder::AddRecordedBody(BodyId id, ChildId child, const ShapePtr& shape) {
    const uint32_t index = static_cast<uint32_t>(ids_.size());
    if (!RecordedBodyOf(id)) {
        if (recorded_.size() <= id.index) recorded_.resize(id.index + 1);
        recorded_[id.index] = index;
    }
    if (child != ChildId{}) recordedChildren_[{id, child}] = index;
    ids_.push_back(id);
    children_.push_back(child);
    settled_.push_back(0);
    islands_.push_back(-1);
    shown_.push_back({shape.get(), RecordShape(shape, id)});
    recording.bodies.push_back({.shape = shown_.back().index,
                                .motion = RecordedMotionOf(world_.Bodies().GetMotionType(id)),
                                .mass = world_.Bodies().GetMass(id),
                                .name = {},
                                .isSensor = world_.Bodies().IsSensor(id)});
    NoteLooks(id, index);
}

bool Recorder::IsThere(uint32_t body) const {
    if (children_[body] == ChildId{}) return world_.Bodies().Exists(ids_[body]);
    const MutableCompound* compound = world_.Bodies().GetChildren(ids_[body]);
    return compound && compound->Exists(children_[body]);
}

ShapePtr Recorder::ShapeOf(uint32_t body) const {
    if (children_[body] == ChildId{}) return world_.Bodies().GetShape(ids_[body]);
    return world_.Bodies().GetChildren(ids_[body])->Children()[children_[body].index].shape;
}

Pose Recorder::PoseOf(uint32_t body) const {
    const Pose pose = world_.Bodies().GetPose(ids_[body]);
    if (children_[body] == ChildId{}) return pose;
    const MutableCompound& compound = *world_.Bodies().GetChildren(ids_[body]);
    const CompoundShape::ChildSettings child = compound.SettingsOf(compound.Children()[children_[body].index]);
    return pose * RelativePose{child.position, child.rotation};
}

void Recorder::AddFrame() {
    AddNewBodies();
    CollectIslands();
    CollectShapes();
    states_.clear();
    const BodyInterface& bodies = world_.Bodies();
    for (uint32_t body = 0; body < ids_.size(); ++body) {
        const BodyId id = ids_[body];
        if (settled_[body] == kGone) continue;
        if (!IsThere(body)) {
            settled_[body] = kGone;
            RecordedState last = recording.latest[body];
            last.velocity = Vector3::Zero();
            last.awake = last.isThere = false;
            states_.push_back(last);
            continue;
        }
        const bool awake = bodies.IsAwake(id);
        const Pose pose = PoseOf(body);
        const bool isMovedChild = children_[body] != ChildId{} && settled_[body] == 1 &&
                                  PlaceFrom(pose.position, recording.origin) != recording.latest[body].position;
        if (settled_[body] == 1 && !awake && !isMovedChild) continue;
        settled_[body] = !awake && recording.bodies[body].motion != RecordedMotion::Kinematic;
        states_.push_back({.body = body,
                           .position = PlaceFrom(pose.position, recording.origin),
                           .rotation = pose.rotation,
                           .velocity = bodies.GetLinearVelocity(id),
                           .awake = awake,
                           .island = islands_[body]});
    }
    contacts_.clear();
    if (!isLive_ && WantsContacts(recording)) CollectContacts();
    CollectDrawing();
    if (!isLive_) CollectFigures();
    AppendFrame(recording, world_.Time(), states_, contacts_, joints_->Collect(recording.joints), {lines_, points_},
                shapeChanges_, figures_);
    figures_ = {};
    stepsOfFigures_ = 0;
}

std::optional<uint32_t> Recorder::RecordedBodyOf(BodyId id) const {
    if (id.index >= recorded_.size()) return std::nullopt;
    const uint32_t body = recorded_[id.index];
    return body < ids_.size() && ids_[body] == id ? std::optional(body) : std::nullopt;
}

// Islands are identified by their first body, so that their numbers and colors stay when others merge.
void Recorder::CollectIslands() {
    firstOfIsland_.clear();
    world_.System().VisitIslands([&](BodyId id, uint32_t island) {
        const int32_t body = static_cast<int32_t>(recorded_[id.index]);
        if (firstOfIsland_.size() <= island) firstOfIsland_.resize(island + 1, -1);
        int32_t& first = firstOfIsland_[island];
        if (first < 0) first = body;
        islands_[static_cast<size_t>(body)] = first;
    });
}

void Recorder::CollectContacts() {
    world_.System().VisitContacts([&](const ContactView& contact) {
        for (const ContactView::Point& point : contact.points)
            contacts_.push_back({.point = PlaceFrom(point.position, recording.origin),
                                 .normal = contact.normal,
                                 .separation = point.separation,
                                 .impulse = point.impulse,
                                 .bodyA = recorded_[contact.bodyA.index],
                                 .bodyB = recorded_[contact.bodyB.index]});
    });
}

void Recorder::CollectDrawing() {
    lines_.clear();
    points_.clear();
    const auto place = [&](const Position& position) { return PlaceFrom(position, recording.origin); };
    for (const DrawnLine& line : world_.Draw().Lines())
        lines_.push_back({place(line.from), place(line.to), static_cast<uint32_t>(line.ink)});
    for (const DrawnPoint& point : world_.Draw().Points())
        points_.push_back({place(point.at), static_cast<uint32_t>(point.ink)});
}

// Bodies whose shape was exchanged or edited. Sleeping ones are skipped, since edits wake bodies.
void Recorder::CollectShapes() {
    shapeChanges_.clear();
    const bool recordsEdits = editedTriangles_ < kMostEditedTriangles || world_.StepCount() == steps_;
    for (uint32_t body = 0; body < ids_.size(); ++body) {
        const bool sleeps = settled_[body] == 1 && recording.bodies[body].motion == RecordedMotion::Dynamic &&
                            !world_.Bodies().IsAwake(ids_[body]);
        if (sleeps || settled_[body] == kGone || !IsThere(body)) continue;
        const ShapePtr shape = ShapeOf(body);
        const bool isField = shape->Type() == ShapeType::HeightField;
        if (shape.get() == shown_[body].shape && !(isField && recordsEdits)) continue;
        const uint32_t index = RecordShape(shape, ids_[body]);
        if (index == shown_[body].index) continue;
        if (isField) editedTriangles_ += recording.shapes[index].triangles.size();
        shown_[body] = {shape.get(), index};
        shapeChanges_.push_back({body, index});
    }
}

}  // namespace fulcrum
