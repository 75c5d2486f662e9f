#include <Fulcrum/Samples/Runner/Recorder.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/SampledSurface.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace fulcrum {
namespace {

constexpr double kFramesPerSecond = 60;
// Each is about 10 bytes of a page.
constexpr double kMostStates = 1.2e6;

constexpr uint8_t kGone = 2;  // of settled_: removed, and hidden already

Vector3 ToVector(const Position& position, const Position& origin) {
    return Vector3((position - origin).cast<float>());
}

RecordedShape RecordedHull(const ConvexHull& hull) {
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    // The recording speaks of the shape's own frame, the hull of its centre of mass.
    for (const Vector3& vertex : hull.Vertices()) shape.vertices.push_back(vertex + hull.Mass().centreOfMass);
    for (const ConvexHull::Face& face : hull.Faces()) {
        const auto corners = hull.Indices().subspan(face.firstIndex, face.cornerCount);
        for (size_t i = 2; i < corners.size(); ++i) shape.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
    return shape;
}

// Whatever else is convex, as the mesh that its support function spans: of a cylinder's rim, points every 4 degrees.
RecordedShape RecordedConvex(const ConvexShape& source) {
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    shape.name = ShapeTypeName(source.Type());
    const SampledSurface surface = SampleSurface(source, 16);
    std::map<std::tuple<float, float, float>, uint32_t> known;  // many directions share a corner
    std::vector<uint32_t> indices;
    for (const Vector3& v : surface.vertices) {
        const auto [at, isNew] = known.emplace(std::tuple(v.x(), v.y(), v.z()), static_cast<uint32_t>(shape.vertices.size()));
        if (isNew) shape.vertices.push_back(v + source.Mass().centreOfMass);
        indices.push_back(at->second);
    }
    for (size_t i = 0; i < surface.indices.size(); i += 3) {
        const auto corner = [&](size_t k) { return indices[static_cast<size_t>(surface.indices[i + k])]; };
        if (corner(0) != corner(1) && corner(1) != corner(2) && corner(0) != corner(2))
            shape.triangles.push_back({corner(0), corner(1), corner(2)});
    }
    return shape;
}

RecordedShape RecordedTriangles(const SurfaceShape& source) {
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    shape.name = ShapeTypeName(source.Type());
    std::map<uint32_t, uint32_t> known;
    source.VisitTriangles(source.LocalBounds(), [&](uint32_t id) {
        const TriangleView view = source.GetTriangle(id);
        std::array<uint32_t, 3> corners;
        for (size_t i = 0; i < 3; ++i) {
            const auto [at, isNew] = known.emplace(view.vertexIds[i], static_cast<uint32_t>(shape.vertices.size()));
            if (isNew) shape.vertices.push_back(view.vertices[i]);
            corners[i] = at->second;
        }
        shape.triangles.push_back(corners);
    });
    return shape;
}

// A square of it around the point nearest to its origin.
RecordedShape RecordedPlane(const Plane& plane) {
    constexpr float kHalf = 100;  // m
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    shape.name = ShapeTypeName(plane.Type());
    const Vector3 centre = plane.Normal() * plane.Offset(), u = Perpendicular(plane.Normal()) * kHalf, v = Cross<float>(plane.Normal(), u);
    shape.vertices = {centre - u - v, centre + u - v, centre + u + v, centre - u + v};
    shape.triangles = {{0, 1, 2}, {0, 2, 3}};
    return shape;
}

RecordedShape RecordedPrimitive(const Shape& source) {
    RecordedShape shape;
    if (const auto* sphere = dynamic_cast<const Sphere*>(&source)) {
        shape.kind = RecordedShapeKind::Sphere;
        shape.radius = sphere->Radius();
    } else if (const auto* box = dynamic_cast<const Box*>(&source)) {
        shape.kind = RecordedShapeKind::Box;
        shape.halfExtents = box->HalfExtents();
    } else if (const auto* capsule = dynamic_cast<const Capsule*>(&source)) {
        shape.kind = RecordedShapeKind::Capsule;
        shape.radius = capsule->Radius();
        shape.halfHeight = capsule->HalfHeight();
    } else if (const auto* hull = dynamic_cast<const ConvexHull*>(&source)) {
        return RecordedHull(*hull);
    } else if (const auto* convex = dynamic_cast<const ConvexShape*>(&source)) {
        return RecordedConvex(*convex);
    } else if (const auto* surface = dynamic_cast<const SurfaceShape*>(&source)) {
        return RecordedTriangles(*surface);
    } else if (const auto* plane = dynamic_cast<const Plane*>(&source)) {
        return RecordedPlane(*plane);
    } else {
        shape.kind = RecordedShapeKind::Compound;  // of nothing
    }
    return shape;
}

RecordedMotion MotionOf(MotionType motion) {
    switch (motion) {
        case MotionType::Static: return RecordedMotion::Static;
        case MotionType::Kinematic: return RecordedMotion::Kinematic;
        default: return RecordedMotion::Dynamic;
    }
}

}  // namespace

Recorder::Recorder(SceneWorld& world, int steps, double dt) : world_(world), steps_(steps) {
    world.Draw().TurnOn();
    recording.title = world.Definition().name;
    recording.description = world.Definition().description;
    double moving = 0;
    world.System().VisitBodies([&](BodyId id) {
        AddBody(id);
        if (world.Bodies().GetMotionType(id) == MotionType::Dynamic && world.Bodies().IsAwake(id)) ++moving;
    });
    joints_.emplace(world.System(), recording.origin, [this](BodyId id) { return RecordedBodyOf(id); });
    const double forRate = 1 / (kFramesPerSecond * dt), forSize = moving * steps / kMostStates;
    interval_ = static_cast<int>(std::max({1.0, std::round(forRate), std::ceil(forSize)}));
    AddFrame();
}

void Recorder::AfterStep() {
    const int step = world_.StepCount();
    if (step % interval_ == 0 || step == steps_) AddFrame();
}

uint32_t Recorder::RecordShape(const ShapePtr& shape) {
    const auto known = shapes_.find(shape.get());
    if (known != shapes_.end()) return known->second;
    RecordedShape recorded;
    if (const auto* compound = dynamic_cast<const CompoundShape*>(shape.get())) {
        recorded.kind = RecordedShapeKind::Compound;
        for (const CompoundShape::ChildSettings& child : compound->Settings())
            recorded.children.push_back({RecordShape(child.shape), {child.position, child.rotation}});
    } else {
        recorded = RecordedPrimitive(*shape);
    }
    const uint32_t index = static_cast<uint32_t>(recording.shapes.size());
    recording.shapes.push_back(std::move(recorded));
    shapes_.emplace(shape.get(), index);
    return index;
}

void Recorder::AddBody(BodyId id) {
    if (recorded_.size() <= id.index) recorded_.resize(id.index + 1);
    recorded_[id.index] = static_cast<uint32_t>(ids_.size());
    const MutableCompound* compound = world_.Bodies().GetChildren(id);
    if (!compound) {
        AddRecordedBody(id, {}, world_.Bodies().GetShape(id));
        return;
    }
    for (uint32_t i = 0; i < compound->Children().size(); ++i)
        if (const ShapePtr& shape = compound->Children()[i].shape) AddRecordedBody(id, compound->IdOf(i), shape);
}

void Recorder::AddRecordedBody(BodyId id, ChildId child, const ShapePtr& shape) {
    ids_.push_back(id);
    children_.push_back(child);
    settled_.push_back(0);
    islands_.push_back(-1);
    recording.bodies.push_back({.shape = RecordShape(shape),
                                .motion = MotionOf(world_.Bodies().GetMotionType(id)),
                                .mass = world_.Bodies().GetMass(id),
                                .name = {}});
}

bool Recorder::IsThere(uint32_t body) const {
    if (children_[body] == ChildId{}) return world_.Bodies().Exists(ids_[body]);
    const MutableCompound* compound = world_.Bodies().GetChildren(ids_[body]);
    return compound && compound->Exists(children_[body]);
}

Pose Recorder::PoseOf(uint32_t body) const {
    const Pose pose = world_.Bodies().GetPose(ids_[body]);
    if (children_[body] == ChildId{}) return pose;
    const MutableCompound& compound = *world_.Bodies().GetChildren(ids_[body]);
    const CompoundShape::ChildSettings child = compound.SettingsOf(compound.Children()[children_[body].index]);
    return pose * RelativePose{child.position, child.rotation};
}

void Recorder::AddFrame() {
    CollectIslands();
    states_.clear();
    const BodyInterface& bodies = world_.Bodies();
    for (uint32_t body = 0; body < ids_.size(); ++body) {
        const BodyId id = ids_[body];
        if (settled_[body] == kGone) continue;
        if (!IsThere(body)) {
            HideRemovedBody(body, recording.latest[body]);
            continue;
        }
        const bool awake = bodies.IsAwake(id);
        const Pose pose = PoseOf(body);
        const bool isMovedChild = children_[body] != ChildId{} && settled_[body] == 1 &&
                                  ToVector(pose.position, recording.origin) != recording.latest[body].position;
        if (settled_[body] == 1 && !awake && !isMovedChild) continue;
        settled_[body] = !awake && recording.bodies[body].motion != RecordedMotion::Kinematic;
        states_.push_back({.body = body,
                           .position = ToVector(pose.position, recording.origin),
                           .rotation = pose.rotation,
                           .velocity = bodies.GetLinearVelocity(id),
                           .awake = awake,
                           .island = islands_[body]});
    }
    contacts_.clear();
    if (WantsContacts(recording)) CollectContacts();
    CollectDrawing();
    AppendFrame(recording, world_.Time(), states_, contacts_, joints_->Collect(recording.joints), {lines_, points_});
}

std::optional<uint32_t> Recorder::RecordedBodyOf(BodyId id) const {
    if (id.index >= recorded_.size()) return std::nullopt;
    const uint32_t body = recorded_[id.index];
    return body < ids_.size() && ids_[body] == id ? std::optional(body) : std::nullopt;
}

// An island is known by its first body, so that its number, and with it its colour, stays when others merge.
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
            contacts_.push_back({.point = ToVector(point.position, recording.origin),
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
    const auto place = [&](const Position& position) { return ToVector(position, recording.origin); };
    for (const DrawnLine& line : world_.Draw().Lines())
        lines_.push_back({place(line.from), place(line.to), static_cast<uint32_t>(line.ink)});
    for (const DrawnPoint& point : world_.Draw().Points()) points_.push_back({place(point.at), static_cast<uint32_t>(point.ink)});
}

// A recording cannot say that a body is gone: it sinks below everything, where floors hide it.
void Recorder::HideRemovedBody(uint32_t body, RecordedState state) {
    settled_[body] = kGone;
    float lowest = 0;
    for (const RecordedState& other : recording.latest) lowest = std::min(lowest, other.position.y());
    state.position.y() = lowest - 1;
    state.velocity = Vector3::Zero();
    state.awake = false;
    states_.push_back(state);
}

}  // namespace fulcrum
