#include <Fulcrum/Physics/Drawing/WorldDrawing.h>

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Drawing/ShapeTriangles.h>

#include <string>

namespace fulcrum {

namespace {

class Drawer {
public:
    Drawer(const PhysicsSystem& system, DrawingTarget& target, const DrawingSettings& settings)
        : system_(system), bodies_(system.Bodies()), target_(target), settings_(settings) {}

    void DrawBody(BodyId id) {
        if (settings_.accepts && !settings_.accepts(id)) return;
        const Pose pose = bodies_.GetPose(id);
        const DrawingColor color = ColorOf(bodies_, id, settings_.colors);
        if (settings_.triangles || settings_.wireframe)
            VisitTriangles(
                *bodies_.GetShape(id), [&](const DrawnTriangle& triangle) { DrawTriangle(pose, triangle, color); },
                settings_.detail, settings_.planeExtent);
        if (settings_.bounds) DrawBounds(bodies_.GetBounds(id));
        const Position center = bodies_.GetCenterOfMass(id);
        if (settings_.centers) DrawFrame({center, pose.rotation}, color);
        if (settings_.velocities) {
            constexpr float kSeconds = 0.1f;
            const Vector3 way = bodies_.GetLinearVelocity(id) * kSeconds;
            if (!way.isZero(0)) target_.Line(center, center + way.cast<double>(), settings_.colors.velocity);
        }
        if (settings_.names) target_.Text(center, std::to_string(id.index), settings_.colors.text);
    }

    void DrawContact(const ContactView& contact) {
        if (settings_.accepts && !settings_.accepts(contact.bodyA) && !settings_.accepts(contact.bodyB)) return;
        for (const ContactView::Point& point : contact.points) {
            const float length = settings_.axisLength * 0.2f + settings_.contactScale * point.impulse;
            target_.Line(point.position, point.position + (contact.normal * length).cast<double>(),
                         settings_.colors.contact);
        }
    }

    void DrawJoint(JointId id) {
        const JointInterface& joints = system_.Joints();
        if (!joints.IsEnabled(id)) return;
        const BodyId sides[2] = {joints.GetBodyA(id), joints.GetBodyB(id)};
        if (settings_.accepts && !settings_.accepts(sides[0]) && !settings_.accepts(sides[1])) return;
        const Pose frames[2] = {joints.GetFrameA(id), joints.GetFrameB(id)};
        for (int side = 0; side < 2; ++side) {
            DrawFrame(frames[side], settings_.colors.joint);
            if (bodies_.Exists(sides[side]))
                target_.Line(bodies_.GetCenterOfMass(sides[side]), frames[side].position, settings_.colors.joint);
        }
        target_.Line(frames[0].position, frames[1].position, settings_.colors.jointGap);
        if (settings_.names) target_.Text(frames[0].position, joints.GetType(id)->Kind(), settings_.colors.text);
    }

private:
    void DrawTriangle(const Pose& pose, const DrawnTriangle& triangle, DrawingColor color) {
        Position corners[3];
        for (int i = 0; i < 3; ++i) corners[i] = pose.Transform(triangle.corners[i]);
        if (settings_.triangles) target_.Triangle(corners[0], corners[1], corners[2], color);
        if (settings_.wireframe)
            for (int i = 0; i < 3; ++i) target_.Line(corners[i], corners[(i + 1) % 3], color);
    }
    void DrawBounds(const BodyBounds& box) {
        const auto corner = [&](int i) {
            return Position(i & 1 ? box.upper.x() : box.lower.x(), i & 2 ? box.upper.y() : box.lower.y(),
                            i & 4 ? box.upper.z() : box.lower.z());
        };
        for (int i = 0; i < 8; ++i)
            for (const int axis : {1, 2, 4})
                if (!(i & axis)) target_.Line(corner(i), corner(i | axis), settings_.colors.bounds);
    }
    void DrawFrame(const Pose& frame, DrawingColor color) {
        for (int axis = 0; axis < 3; ++axis) {
            Vector3 end = Vector3::Zero();
            end[axis] = settings_.axisLength * (axis == 0 ? 1 : 0.5f);  // x is the longest
            target_.Line(frame.position, frame.Transform(end), color);
        }
    }

    const PhysicsSystem& system_;
    const BodyInterface& bodies_;
    DrawingTarget& target_;
    const DrawingSettings& settings_;
};

}  // namespace

DrawingColor ColorOf(const BodyInterface& bodies, BodyId id, const DrawingColors& colors) {
    if (bodies.IsFrozen(id)) return colors.frozen;
    if (bodies.IsSensor(id)) return colors.sensor;
    const MotionType motion = bodies.GetMotionType(id);
    if (motion == MotionType::Static) return colors.fixed;
    if (motion == MotionType::Kinematic) return colors.kinematic;
    return bodies.IsAwake(id) ? colors.awake : colors.asleep;
}

void Draw(const PhysicsSystem& system, DrawingTarget& target, const DrawingSettings& settings) {
    const DefaultFloats floats;
    Drawer drawer(system, target, settings);
    system.VisitBodies([&](BodyId id) { drawer.DrawBody(id); });
    if (settings.contacts) system.VisitContacts([&](const ContactView& contact) { drawer.DrawContact(contact); });
    if (settings.joints) system.Joints().Visit([&](JointId id) { drawer.DrawJoint(id); });
}

}  // namespace fulcrum
