// Paths: length, frame and nearest places; the rows of what rides on them.
#include "JointCases.h"

#include <Fulcrum/Physics/Joints/PathJoint.h>

#include <Eigen/Geometry>

#include <cmath>

namespace fulcrum::testing {
namespace {

using PathPointer = std::shared_ptr<const Path>;

// Half a meter high at one side, of about 2 m radius.
PathPointer MakeLoop() {
    std::vector<Vector3> positions, normals;
    for (int i = 0; i < 8; ++i) {
        const float angle = 0.785398163f * static_cast<float>(i);
        const SineCosine<float> at = SinCos(angle);
        positions.push_back(Vector3(2 * at.cosine, 0.25f * at.sine, 1.6f * at.sine));
        normals.push_back(Normalized(Vector3(0.4f * at.cosine, 1, 0.2f)));
    }
    return Path::CatmullRom(positions, normals, true).Value();
}
PathPointer MakeBow() {
    const PathPoint points[] = {{Vector3(0, 0, 0), Vector3(2, 0, 0)},
                                {Vector3(2, 1, 0), Vector3(2, 2, 1), Vector3(-0.5f, 1, 0)},
                                {Vector3(2.5f, 3, 1), Vector3(0, 2, 0), Vector3(-1, 0, 0)}};
    return Path::Hermite(points, false).Value();
}

TEST(Path, OfEqualChordsIsStraightAndAsLongAsItIs) {
    const Vector3 positions[] = {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(2, 0, 0), Vector3(3, 0, 0)};
    const Vector3 up[] = {Vector3(0, 1, 0)};
    const PathPointer path = Path::CatmullRom(positions, up, false).Value();
    EXPECT_NEAR(path->Length(), 3.0, 1e-6);
    for (const double t : {0.0, 0.3, 1.5, 2.99, 3.0}) {
        EXPECT_NEAR(path->LengthAt(t), t, 1e-6);
        EXPECT_LT((path->Sample(t).position - Vector3(static_cast<float>(t), 0, 0)).norm(), 1e-6f);
        EXPECT_LT(path->Sample(t).turn.norm(), 1e-6f);
        EXPECT_NEAR(path->Closest(Vector3(static_cast<float>(t), 0.4f, -2.0f)), t, 1e-6);
    }
    EXPECT_EQ(path->Closest(Vector3(5, 0, 0)), 3.0);
    EXPECT_EQ(path->Closest(Vector3(-5, 0, 0)), 0.0);
}

TEST(Path, PassesItsPointsWithOneTangent) {
    const PathPointer path = MakeLoop();
    for (int i = 0; i < 8; ++i) {
        const double t = i;
        EXPECT_LT((path->Sample(t).tangent - path->Sample(t - 1e-9).tangent).norm(), 1e-5f);
        EXPECT_LT((path->Sample(t).position - path->Sample(t + 8.0).position).norm(), 1e-6f);
    }
    EXPECT_NEAR(path->LengthAt(10.5) - path->LengthAt(2.5), path->Length(), 1e-9);
    EXPECT_NEAR(path->LengthAt(-5.5) - path->LengthAt(2.5), -path->Length(), 1e-9);
}

TEST(Path, LengthIsTheSumOfShortChords) {
    // Chords of the length s / 500 are short of the arc by about (curvature s / 500)^2 / 24: 1e-6.
    for (const PathPointer& path : {MakeLoop(), MakeBow()}) {
        const int count = 500 * static_cast<int>(path->End());
        double sum = 0;
        for (int i = 0; i < count; ++i)
            sum += (path->Sample(static_cast<double>(i + 1) / 500).position -
                    path->Sample(static_cast<double>(i) / 500).position)
                       .cast<double>()
                       .norm();
        EXPECT_NEAR(path->Length(), sum, 2e-5 * sum);
    }
}

TEST(Path, TurnIsTheRateOfItsFrame) {
    constexpr double kWay = 2e-3;
    for (const PathPointer& path : {MakeLoop(), MakeBow()})
        for (double t = 0.05; t < path->End(); t += 0.173) {
            const PathSample here = path->Sample(t), ahead = path->Sample(t + kWay), behind = path->Sample(t - kWay);
            const float inverse = 1.0f / static_cast<float>(path->LengthAt(t + kWay) - path->LengthAt(t - kWay));
            EXPECT_LT(((ahead.tangent - behind.tangent) * inverse - Cross(here.turn, here.tangent)).norm(), 2e-3f);
            EXPECT_LT(((ahead.normal - behind.normal) * inverse - Cross(here.turn, here.normal)).norm(), 2e-3f);
            EXPECT_NEAR(Dot(here.tangent, here.normal), 0.0f, 1e-6f);
            EXPECT_NEAR(here.normal.norm(), 1.0f, 1e-6f);
        }
}

TEST(Path, TheNearestPlaceIsFoundFromNearby) {
    // A point beside the path at t; slope / |P'|^2 is what a digit of the position moves t by.
    for (const PathPointer& path : {MakeLoop(), MakeBow()})
        for (double t = 0.02; t < path->End(); t += 0.037) {
            const PathSample at = path->Sample(t);
            const Vector3 point = at.position + at.normal * 0.1f - at.binormal * 0.1f;
            EXPECT_NEAR(path->Closest(point, std::min(t + 0.2, path->End())), t, 3e-6);
            EXPECT_NEAR(path->Closest(point), t, 3e-6);
        }
}

TEST(Path, IsFollowedAroundManyLaps) {
    const PathPointer path = MakeLoop();
    double t = 0.0;
    for (int i = 0; i < 800 * 5; ++i) t = path->Closest(path->Sample(0.01 * i).position, t);
    EXPECT_NEAR(t, 39.99, 1e-4);
}

TEST(Path, SaysWhatIsWrong) {
    const Vector3 same[] = {Vector3(1, 0, 0), Vector3(1, 0, 0)}, line[] = {Vector3(0, 0, 0), Vector3(1, 0, 0)};
    const Vector3 up[] = {Vector3(0, 1, 0)}, ahead[] = {Vector3(1, 0, 0)}, bad[] = {Vector3(0, NAN, 0)};
    const auto errorOf = [](std::span<const Vector3> positions, std::span<const Vector3> normals) {
        const auto result = Path::CatmullRom(positions, normals, false);
        EXPECT_FALSE(result);
        return result ? ErrorCode::Unsupported : result.GetError().code;
    };
    EXPECT_EQ(errorOf(same, up), ErrorCode::Degenerate);
    EXPECT_EQ(errorOf(std::span(line).first(1), up), ErrorCode::Degenerate);
    EXPECT_EQ(errorOf(line, ahead), ErrorCode::Degenerate);
    EXPECT_EQ(errorOf(line, bad), ErrorCode::NonFinite);
    EXPECT_EQ(errorOf(line, {}), ErrorCode::OutOfRange);
}

// B on the path at t, turned against the path's frame by `turn`, and `way` m farther along the tangent.
void PlaceOnPath(JointBodies& bodies, const Path& path, double t, const Quaternion& turn, float way = 0.0f) {
    const PathSample at = path.Sample(t);
    Eigen::Matrix3f axes;
    const Eigen::Vector3f tangent = at.tangent, normal = at.normal, binormal = at.binormal;
    axes << tangent, normal, binormal;
    const Eigen::Quaternionf q(axes);
    bodies.PlaceB(Vector3(at.position + at.tangent * way), Quaternion{q.x(), q.y(), q.z(), q.w()} * turn);
}

TEST(PathJoint, RowsAreTheDerivativesOfWhatIsOffThePath) {
    RandomPoses random(16);
    AxisControl motor = Driven(MotorMode::ToPosition, 1.0f);
    for (const PathPointer& path : {MakeLoop(), MakeBow()})
        for (const PathRotation rotation : {PathRotation::Free, PathRotation::Tangent, PathRotation::TangentAndNormal})
            for (int i = 0; i < 10; ++i) {
                JointBodies bodies = JointBodies::AtRandom(random);
                const double t = static_cast<double>(random.Between(0.2f, 1.7f));
                const bool spins = rotation != PathRotation::TangentAndNormal;
                PlaceOnPath(bodies, *path, t, spins ? AboutX(random.Between(-3, 3)) : Quaternion{});
                PathJoint joint(path, motor, rotation);
                joint.Start(bodies.Pose());
                EXPECT_NEAR(joint.Coordinate(JointAxis::LinearX, bodies.Pose()), path->LengthAt(t), 1e-5);
                ExpectJacobiansOf(joint, bodies, 4e-3f);
            }
}

// Beyond an end the path goes on straight, where a soft limit lets B run.
TEST(PathJoint, RowsAreTheDerivativesOfWhatIsOffTheTangentBeyondTheEnds) {
    RandomPoses random(17);
    AxisControl control = Driven(MotorMode::ToPosition, 1.0f);
    control.limits.spring.frequency = 2.0f;
    const PathPointer path = MakeBow();
    for (const PathRotation rotation : {PathRotation::Free, PathRotation::Tangent, PathRotation::TangentAndNormal})
        for (const double end : {0.0, path->End()})
            for (const float beyond : {0.02f, 0.3f, 4.0f}) {
                const float way = end > 0 ? beyond : -beyond;
                JointBodies bodies = JointBodies::AtRandom(random);
                PlaceOnPath(bodies, *path, end, rotation == PathRotation::Tangent ? AboutX(0.7f) : Quaternion{}, way);
                PathJoint joint(path, control, rotation);
                joint.Start(bodies.Pose());
                EXPECT_NEAR(joint.Coordinate(JointAxis::LinearX, bodies.Pose()),
                            path->LengthAt(end) + static_cast<double>(way), 1e-5);
                for (const auto& [slot, row] : RowsOf(joint, bodies.Pose()))
                    if (row.kind == JointRow::Kind::Equal) {
                        EXPECT_NEAR(row.error, 0.0f, 1e-5f) << slot;
                    }
                ExpectJacobiansOf(joint, bodies, 4e-3f);
            }
}

TEST(PathJoint, HasNoErrorOnThePath) {
    JointBodies bodies;
    const PathPointer path = MakeLoop();
    for (const PathRotation rotation : {PathRotation::Tangent, PathRotation::TangentAndNormal}) {
        PathJoint joint(path, {}, rotation);
        PlaceOnPath(bodies, *path, 0.0, {});
        joint.Start(bodies.Pose());
        for (int i = 0; i < 800; ++i) {
            PlaceOnPath(bodies, *path, 0.05 * i, rotation == PathRotation::Tangent ? AboutX(1.0f) : Quaternion{});
            for (const auto& [slot, row] : RowsOf(joint, bodies.Pose())) ASSERT_NEAR(row.error, 0.0f, 3e-6f) << slot;
        }
        EXPECT_NEAR(joint.Coordinate(JointAxis::LinearX, bodies.Pose()), path->LengthAt(39.95), 1e-4);
    }
}

TEST(PathJoint, ComesBackFromTheOppositeOrientation) {
    JointBodies bodies;
    const PathPointer path = MakeLoop();
    PathJoint joint(path, {}, PathRotation::Tangent);
    PlaceOnPath(bodies, *path, 1.0, AboutY(3.14159265f));
    joint.Start(bodies.Pose());
    auto rows = RowsOf(joint, bodies.Pose());
    EXPECT_NEAR(std::hypot(rows[7].error, rows[8].error), 3.14159265f, 1e-5f);
}

TEST(PathJoint, AnOpenPathHasStopsAtItsEnds) {
    JointBodies bodies;
    PathJoint joint(Path::Straight(4.0f), {}, PathRotation::Free);
    EXPECT_EQ(joint.MaxRows(), 4u);
    const int low = static_cast<int>(joint.FirstSlot(JointAxis::LinearX)), high = low + 1;
    const auto rowsAt = [&](float x) {
        bodies.PlaceB(Vector3(x, 0, 0), {});
        return RowsOf(joint, bodies.Pose());
    };
    EXPECT_EQ(rowsAt(0.0f).size(), 2u);
    EXPECT_NEAR(rowsAt(1.999f)[high].error, 0.001f, 1e-6f);
    EXPECT_NEAR(rowsAt(2.5f)[high].error, -0.5f, 1e-6f);
    EXPECT_NEAR(rowsAt(-2.5f)[low].error, -0.5f, 1e-6f);
}

TEST(PathJoint, LocksRotationAgainstAAsABlock) {
    EXPECT_EQ(PathJoint(Path::Straight(1.0f), {}, PathRotation::Constant).Locks().angular, AngularLock::All);
}

}  // namespace
}  // namespace fulcrum::testing
