// A contact batch against the same rows as a sequence of row parts along and about axes, and against conservation of
// momentum.
#include <Fulcrum/Constraints/Parts/AnglePart.h>
#include <Fulcrum/Constraints/Parts/AxisPart.h>
#include <Fulcrum/UnitTests/Constraints/Contacts/RandomContacts.h>

#include <Eigen/LU>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum::testing {
namespace {

constexpr ContactPrepareSettings kPrepare{1.0f, 0.5f};
// Hard rows: nothing is pushed. Friction is solved in each pass. No hit counts, so that row follows row.
constexpr ContactSolveSettings kSolve{.inverseDt = 240.0f,
                                      .elapsed = 0,
                                      .pushRate = 0,
                                      .massScale = 1,
                                      .impulseScale = 0,
                                      .slop = 0,
                                      .relaxes = false,
                                      .leastError = std::numeric_limits<float>::max()};

// One contact, row by row: friction along two tangents and about the normal first, then the points.
template <BodySide kSideB>
class Rows {
public:
    Rows(const RandomContacts& contacts, uint32_t contact) : record_(contacts.records[contact]) {
        const InverseMass<float> mass1 = contacts.MassOf(2 * contact), mass2 = contacts.MassOf(2 * contact + 1);
        const Pose a = contacts.PoseOf(2 * contact), b = contacts.PoseOf(2 * contact + 1);
        const Vector3 between((b.position - a.position).cast<float>());
        count_ = static_cast<int>(record_.pointCount);
        const Vector3 normal = Rotate(a.rotation, Vector3(record_.normal[0], record_.normal[1], record_.normal[2]));
        const Vector3 t1 = Perpendicular(normal), t2 = Cross<float>(normal, t1);
        Vector3 points[4], center = Vector3::Zero();
        for (int i = 0; i < count_; ++i) {
            const ContactRecord::Point& p = record_.points[i];
            const Vector3 onA = Rotate(a.rotation, Vector3(p.onA[0], p.onA[1], p.onA[2]));
            const Vector3 onB = between + Rotate(b.rotation, Vector3(p.onB[0], p.onB[1], p.onB[2]));
            separation_[i] = Dot<float>(normal, Vector3(onB - onA));
            points[i] = onA + normal * (0.5f * separation_[i]);
        }
        // The center of those that press.
        const auto presses = [&](int i) { return record_.impulse[i] > 0; };
        int pressing = 0;
        for (int i = 0; i < count_; ++i) pressing += presses(i);
        for (int i = 0; i < count_; ++i)
            if (presses(i) || pressing == 0) center += points[i] / static_cast<float>(pressing ? pressing : count_);
        const auto setUp = [&](RowPart<float>& row, const RowJacobian<float>& jacobian) {
            row.SetJacobian(jacobian);
            row.CalculateProperties<BodySide::Dynamic, kSideB>(mass1, mass2);
            row.SetBias(0.0f);
        };
        // A single point rubs where the surfaces will meet.
        const Vector3 toSurface = normal * (count_ == 1 ? 0.5f * std::max(separation_[0], 0.0f) : 0.0f);
        const auto along = [&](const Vector3& point, const Vector3& axis, const Vector3& apart = Vector3::Zero()) {
            return AxisJacobian<float>({Vector3(point - apart), Vector3(point + apart - between), axis});
        };
        for (int i = 0; i < count_; ++i) {
            setUp(point_[i], along(points[i], normal));
            point_[i].SetTotalLambda(record_.impulse[i]);
        }
        const Vector3 friction(record_.frictionImpulse[0], record_.frictionImpulse[1], record_.frictionImpulse[2]);
        setUp(tangent1_, along(center, t1, toSurface));
        setUp(tangent2_, along(center, t2, toSurface));
        setUp(twist_, AngleJacobian(normal));
        tangent1_.SetTotalLambda(Dot<float>(friction, t1));
        tangent2_.SetTotalLambda(Dot<float>(friction, t2));
        twist_.SetTotalLambda(record_.twistImpulse);
    }

    void WarmStart(Twist<float>& v1, Twist<float>& v2) {
        tangent1_.WarmStart<BodySide::Dynamic, kSideB>(v1, v2);
        tangent2_.WarmStart<BodySide::Dynamic, kSideB>(v1, v2);
        twist_.WarmStart<BodySide::Dynamic, kSideB>(v1, v2);
        for (int i = 0; i < count_; ++i) point_[i].WarmStart<BodySide::Dynamic, kSideB>(v1, v2);
    }

    void SolveVelocity(Twist<float>& v1, Twist<float>& v2) {
        // The limit of friction is that of the normal impulses which the points would have without it.
        Twist<float> trial1 = v1, trial2 = v2;
        const Rows before = *this;
        SolveNormals(trial1, trial2);
        float sum = 0;
        for (int i = 0; i < count_; ++i) sum += point_[i].GetTotalLambda();
        *this = before;
        SolveFriction(v1, v2, record_.friction * sum);
        SolveNormals(v1, v2);
    }
    void SolveFriction(Twist<float>& v1, Twist<float>& v2, float limit) {
        // Both tangents' impulses are found, one after the other, before they are clamped to the cone together.
        const float before1 = tangent1_.GetTotalLambda(), before2 = tangent2_.GetTotalLambda();
        Twist<float> w1 = v1, w2 = v2;
        const float wanted1 = tangent1_.SolveTotalLambda<BodySide::Dynamic, kSideB>(w1, w2);
        tangent1_.ApplyTotalLambda<BodySide::Dynamic, kSideB>(w1, w2, wanted1);
        const float wanted2 = tangent2_.SolveTotalLambda<BodySide::Dynamic, kSideB>(w1, w2);
        tangent1_.SetTotalLambda(before1);
        tangent2_.SetTotalLambda(before2);
        if (wanted1 * wanted1 + wanted2 * wanted2 <= limit * limit) {
            tangent1_.ApplyTotalLambda<BodySide::Dynamic, kSideB>(v1, v2, wanted1);
            tangent2_.ApplyTotalLambda<BodySide::Dynamic, kSideB>(v1, v2, wanted2);
        } else {
            // Against the slip: the same mass for both, the least of any direction.
            const float slip1 = SlipAlong(tangent1_, v1, v2), slip2 = SlipAlong(tangent2_, v1, v2);
            Twist<float> unit1, unit2;
            RowPart<float> row = tangent1_;
            row.SetTotalLambda(0);
            row.ApplyTotalLambda<BodySide::Dynamic, kSideB>(unit1, unit2, 1);
            const float k1 = SlipAlong(tangent1_, unit1, unit2), k = SlipAlong(tangent2_, unit1, unit2),
                        k2 = 1 / tangent2_.GetEffectiveMass();
            const float mass = 1 / (0.5f * (k1 + k2) + std::hypot(0.5f * (k1 - k2), k));
            const float slide1 = before1 - mass * slip1, slide2 = before2 - mass * slip2;
            const float scale = std::min(limit / std::hypot(slide1, slide2), 1.0f);
            tangent1_.ApplyTotalLambda<BodySide::Dynamic, kSideB>(v1, v2, slide1 * scale);
            tangent2_.ApplyTotalLambda<BodySide::Dynamic, kSideB>(v1, v2, slide2 * scale);
        }
        const float most = limit * record_.twistRadius;
        twist_.SolveVelocity<BodySide::Dynamic, kSideB>(v1, v2, -most, most);
    }
    // By the impulses that the normals have.
    void SolveFriction(Twist<float>& v1, Twist<float>& v2) {
        float sum = 0;
        for (int i = 0; i < count_; ++i) sum += point_[i].GetTotalLambda();
        SolveFriction(v1, v2, record_.friction * sum);
    }
    // m/s of the row's motion.
    static float SlipAlong(RowPart<float> row, Twist<float> v1, Twist<float> v2) {
        row.SetTotalLambda(0);
        return -row.SolveTotalLambda<BodySide::Dynamic, kSideB>(v1, v2) / row.GetEffectiveMass();
    }
    void SolveNormals(Twist<float>& v1, Twist<float>& v2) {
        for (int i = 0; i < count_; ++i) {
            point_[i].SetBias(std::max(separation_[i], 0.0f) * kSolve.inverseDt);
            point_[i].SolveVelocity<BodySide::Dynamic, kSideB>(v1, v2, 0.0f, 1e30f);
        }
    }

    int count_ = 0;
    RowPart<float> point_[4], tangent1_, tangent2_, twist_;

private:
    ContactRecord record_;
    float separation_[4] = {};
};

// Numbers are of size 10 and go through some hundred roundings of 2^-24, some of differences.
constexpr float kTolerance = 2e-4f;

void ExpectNear(const Twist<float>& a, const Twist<float>& b, const char* what, uint32_t contact) {
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(a.linear[k], b.linear[k], kTolerance) << what << " of contact " << contact;
        EXPECT_NEAR(a.angular[k], b.angular[k], kTolerance) << what << " of contact " << contact;
    }
}

template <bool kFixedB>
void CompareWithParts(uint32_t seed) {
    constexpr BodySide kSideB = kFixedB ? BodySide::Kinematic : BodySide::Dynamic;
    RandomContacts contacts(16, kFixedB, seed);
    for (ContactRecord& record : contacts.records)
        record.restitution = 0;  // what bounces off would not be warm started
    for (uint32_t i = 0; i < 16; ++i) {
        Rows<kSideB> rows(contacts, i);
        auto batch = PrepareBatch<1, kFixedB>(contacts, i, kPrepare);
        Twist<float> v1 = contacts.VelocityOf(2 * i), v2 = contacts.VelocityOf(2 * i + 1);

        WarmStartContacts(batch, contacts.states.data());
        rows.WarmStart(v1, v2);
        ExpectNear(contacts.VelocityOf(2 * i), v1, "warm start, A", i);
        ExpectNear(contacts.VelocityOf(2 * i + 1), v2, "warm start, B", i);
        for (int iteration = 0; iteration < 3; ++iteration) {
            SolveContactVelocities(batch, contacts.states.data(), kSolve);
            rows.SolveVelocity(v1, v2);
            ExpectNear(contacts.VelocityOf(2 * i), v1, "velocity, A", i);
            ExpectNear(contacts.VelocityOf(2 * i + 1), v2, "velocity, B", i);
            for (int p = 0; p < rows.count_; ++p)
                EXPECT_NEAR(batch.rows[p].impulse[0], rows.point_[p].GetTotalLambda(), 10 * kTolerance);
            EXPECT_NEAR(batch.frictionImpulse[0][0], rows.tangent1_.GetTotalLambda(), 10 * kTolerance);
            EXPECT_NEAR(batch.frictionImpulse[1][0], rows.tangent2_.GetTotalLambda(), 10 * kTolerance);
            EXPECT_NEAR(batch.frictionImpulse[2][0], rows.twist_.GetTotalLambda(), 10 * kTolerance);
        }

        // Nobody has moved yet, so relaxing is one more velocity iteration.
        RelaxContacts(batch, contacts.states.data(), kSolve);
        rows.SolveVelocity(v1, v2);
        ExpectNear(contacts.VelocityOf(2 * i), v1, "relaxed, A", i);
        ExpectNear(contacts.VelocityOf(2 * i + 1), v2, "relaxed, B", i);
        // Where relaxing passes follow, velocity passes leave friction to them, but for that of what moves by itself,
        // which they solve before the normals and after them.
        ContactSolveSettings normalsAlone = kSolve;
        normalsAlone.relaxes = true;
        SolveContactVelocities(batch, contacts.states.data(), normalsAlone);
        if (kFixedB) {
            rows.SolveVelocity(v1, v2);
            rows.SolveFriction(v1, v2);
        } else {
            rows.SolveNormals(v1, v2);
        }
        ExpectNear(contacts.VelocityOf(2 * i), v1, "normals, A", i);
        ExpectNear(contacts.VelocityOf(2 * i + 1), v2, "normals, B", i);
        if (::testing::Test::HasFailure()) return;
    }
}

TEST(ContactBatch, IsTheSequenceOfItsParts) {
    for (uint32_t seed = 1; seed <= 10; ++seed) CompareWithParts<false>(seed);
}

TEST(ContactBatch, IsTheSequenceOfItsPartsAgainstAFixedBody) {
    for (uint32_t seed = 1; seed <= 10; ++seed) CompareWithParts<true>(seed);
}

// A block of 2 kg that falls flat at 3 m/s onto what does not move. Its four points stop it with equal impulses, m v
// / 4. Where the warm start is four times that, they part at 9 m/s, and the impulses are scaled back.
TEST(ContactBatch, APassStopsAFlatHitWithoutSpin) {
    constexpr float kMass = 2, kSpeed = 3;
    for (const float warm : {0.0f, 4.0f}) {
        RandomContacts contacts(1, true, 1);
        contacts.poses[0] = contacts.poses[1] = BodyPose{};
        contacts.poses[0].position[1] = 1;
        contacts.poses[0].rotation[3] = contacts.poses[1].rotation[3] = 1;
        contacts.states[0] = contacts.states[1] = BodyState{};
        contacts.states[0].linearVelocity[1] = (warm - 1) * kSpeed;
        contacts.masses[0].inverseMass = 1 / kMass;
        const float inertia[6] = {1, 2, 3, 0, 0, 0};
        std::copy_n(inertia, 6, contacts.masses[0].inverseInertia);
        ContactRecord& record = contacts.records[0];
        record = ContactRecord{};
        record.normal[1] = -1;
        record.pointCount = 4;
        record.friction = 0.5f;
        for (int i = 0; i < 4; ++i) {
            ContactRecord::Point& point = record.points[i];
            point.onA[0] = point.onB[0] = i % 2 == 0 ? 0.5f : -0.5f;
            point.onA[2] = point.onB[2] = i / 2 == 0 ? 0.3f : -0.3f;
            point.onA[1] = -1;
            record.impulse[i] = warm * kMass * kSpeed / 4;
        }
        auto batch = PrepareBatch<1, true>(contacts, 0, kPrepare);
        ContactSolveSettings settings = kSolve;
        settings.leastError = 0.16f;
        SolveContactVelocities(batch, contacts.states.data(), settings);
        const Twist<float> v = contacts.VelocityOf(0);
        EXPECT_LT(v.linear.norm(), 1e-6f) << warm;
        EXPECT_LT(v.angular.norm(), 1e-6f) << warm;
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(batch.rows[i].impulse[0], kMass * kSpeed / 4, 1e-6f) << warm;
    }
}

Eigen::Matrix3d InertiaOf(const InverseMass<float>& mass) {
    Eigen::Matrix3d inverse;
    const auto& i = mass.inertia;
    inverse << double(i.xx), double(i.xy), double(i.xz), double(i.xy), double(i.yy), double(i.yz), double(i.xz),
        double(i.yz), double(i.zz);
    return inverse.inverse();
}

Position Times(const Eigen::Matrix3d& m, const Position& v) { return m * Eigen::Vector3d(v.x(), v.y(), v.z()); }

// Momentum of both bodies about the world's origin, in double.
void Momentum(const RandomContacts& contacts, uint32_t contact, Position& linear, Position& angular) {
    linear = angular = Position::Zero();
    for (uint32_t body = 2 * contact; body < 2 * contact + 2; ++body) {
        const Twist<float> v = contacts.VelocityOf(body);
        const InverseMass<float> m = contacts.MassOf(body);
        const Position p = v.linear.cast<double>() / double(m.mass.x());
        linear += p;
        angular += Times(InertiaOf(m), v.angular.cast<double>()) + contacts.PoseOf(body).position.cross(p);
    }
}

TEST(ContactBatch, KeepsLinearAndAngularMomentum) {
    RandomContacts contacts(64, false, 5);
    // With restitution, friction acts at the points where the surfaces will meet, not at one common point of the
    // present poses. Likewise with a single point, which lets friction's impulse act at arms apart by the gap.
    for (ContactRecord& record : contacts.records) record.restitution = 0;
    for (uint32_t i = 0; i < 64; ++i) {
        Position linear, angular, linearAfter, angularAfter;
        Momentum(contacts, i, linear, angular);
        auto batch = PrepareBatch<1, false>(contacts, i, kPrepare);
        WarmStartContacts(batch, contacts.states.data());
        for (int k = 0; k < 4; ++k) SolveContactVelocities(batch, contacts.states.data(), kSolve);
        Momentum(contacts, i, linearAfter, angularAfter);
        if (batch.pointCount == 1) {
            const auto component = [](const auto& v, int k) { return double{v[k][0]}; };
            Position gap, friction;
            for (int k = 0; k < 3; ++k) {
                gap[k] = component(batch.normal, k) * std::max(double{batch.rows[0].startSeparation[0]}, 0.0);
                friction[k] = component(batch.tangent1, k) * double{batch.frictionImpulse[0][0]} +
                              component(batch.tangent2, k) * double{batch.frictionImpulse[1][0]};
            }
            angularAfter -= gap.cross(friction);
        }
        // Inverse masses and inertias are from 0.1 on: each rounding of a velocity of size 10 is one of 1e-5 of
        // momentum.
        EXPECT_LT((linearAfter - linear).norm(), 3e-4) << i;
        EXPECT_LT((angularAfter - angular).norm(), 2e-3) << i;
    }
}

double KineticEnergy(const RandomContacts& contacts, uint32_t contact) {
    double sum = 0;
    for (uint32_t body = 2 * contact; body < 2 * contact + 2; ++body) {
        const Twist<float> v = contacts.VelocityOf(body);
        const InverseMass<float> m = contacts.MassOf(body);
        const Position w = v.angular.cast<double>();
        sum += 0.5 * v.linear.cast<double>().squaredNorm() / double(m.mass.x()) + 0.5 * w.dot(Times(InertiaOf(m), w));
    }
    return sum;
}

// Up to four points and friction: Newton's law alone would gain in a quarter of these.
TEST(ContactBatch, ABounceGivesBackNoMoreThanTheContactTook) {
    ContactSolveSettings settings = kSolve;
    settings.restitutionSpeed = kPrepare.restitutionSpeed;
    int bounced = 0;
    for (uint32_t i = 0; i < 256; ++i) {
        double before = 0, after[2];
        for (const int restitution : {0, 1}) {
            RandomContacts contacts(256, false, 6);
            ContactRecord& record = contacts.records[i];
            record.restitution = static_cast<float>(restitution);
            for (float& impulse : record.impulse) impulse = 0;
            for (float& impulse : record.frictionImpulse) impulse = 0;
            record.twistImpulse = 0;
            auto batch = PrepareBatch<1, false>(contacts, i, kPrepare);
            const RareContactData rare = contacts.Rare();
            settings.rare = &rare;
            before = KineticEnergy(contacts, i);
            for (int k = 0; k < 3; ++k) SolveContactVelocities(batch, contacts.states.data(), settings);
            after[restitution] = KineticEnergy(contacts, i);
        }
        bounced += after[1] > 1.001 * after[0];
        // Sums of some ten numbers of size 10, in floats.
        EXPECT_LE(after[1], before * (1 + 1e-5)) << i;
    }
    EXPECT_GT(bounced, 20);
}

TEST(ContactBatch, LeavesNoApproachBehind) {
    // One point, without friction: after one solve the gap at most closes.
    RandomContacts contacts(64, false, 9);
    for (ContactRecord& record : contacts.records) {
        record.pointCount = 1;
        record.friction = 0;
        for (float& impulse : record.impulse) impulse = 0;
        for (float& impulse : record.frictionImpulse) impulse = 0;
        record.twistImpulse = 0;
    }
    const RareContactData rare = contacts.Rare();
    ContactSolveSettings settings = kSolve;
    settings.rare = &rare;
    for (uint32_t i = 0; i < 64; ++i) {
        auto batch = PrepareBatch<1, false>(contacts, i, kPrepare);
        SolveContactVelocities(batch, contacts.states.data(), settings);
        const Twist<float> a = contacts.VelocityOf(2 * i), b = contacts.VelocityOf(2 * i + 1);
        const auto vec = [](const Vec3<Wide<1>>& v) { return Lane<1>(v, 0); };
        const Vector3 relative = b.linear + Cross<float>(b.angular, vec(batch.sideB.arm)) - a.linear -
                                 Cross<float>(a.angular, vec(batch.armA));
        const float allowed = -std::max(batch.rows[0].startSeparation[0], 0.0f) * kSolve.inverseDt;
        EXPECT_GE(Dot<float>(relative, vec(batch.normal)), allowed - 1e-5f) << i;
        EXPECT_GE(batch.rows[0].impulse[0], 0.0f);
    }
}

TEST(ContactBatch, AFixedSideIsNeitherReadAsMovableNorWritten) {
    RandomContacts contacts(16, true, 4);
    const std::vector<BodyState> before = contacts.states;
    const RareContactData rare = contacts.Rare();
    ContactSolveSettings settings = kSolve;
    settings.rare = &rare;
    for (uint32_t i = 0; i < 16; ++i) {
        auto batch = PrepareBatch<1, true>(contacts, i, kPrepare);
        WarmStartContacts(batch, contacts.states.data());
        SolveContactVelocities(batch, contacts.states.data(), settings);
        RelaxContacts(batch, contacts.states.data(), settings);
        EXPECT_EQ(std::memcmp(&contacts.states[2 * i + 1], &before[2 * i + 1], sizeof(BodyState)), 0);
    }
}

TEST(ContactBatch, SeparationsFollowTheDisplacements) {
    RandomContacts contacts(16, false, 5);
    for (uint32_t i = 0; i < 16; ++i) {
        auto batch = PrepareBatch<1, false>(contacts, i, kPrepare);
        const Vector3 normal = Lane<1>(batch.normal, 0);
        BodyState& b = contacts.states[2 * i + 1];
        for (int k = 0; k < 3; ++k) b.deltaPosition[k] = 0.25f * normal[k];
        UpdateSeparations(batch, contacts.states.data(), kSolve);
        // A quarter of a meter along the normal opens every gap by as much; rounded at a size of 10.
        for (int p = 0; p < batch.pointCount; ++p)
            EXPECT_NEAR(batch.rows[p].separation[0], batch.rows[p].startSeparation[0] + 0.25f, 1e-5f);
    }
}

TEST(ContactSolveSettings, SoftenIsTheSoftConstraintOfTheSpring) {
    // k = m w^2, c = 2 m zeta w with m = 1: gamma = 1 / (h (c + h k)), beta = h k / (c + h k). The row's effective mass
    // is 1 / (1 + gamma), the part of the impulse that softness removes gamma / (1 + gamma), its push beta / h per
    // meter.
    const double f = 60, zeta = 10, h = 1.0 / 240, w = 2 * M_PI * f, k = w * w, c = 2 * zeta * w;
    const double gamma = 1 / (h * (c + h * k)), beta = h * k / (c + h * k);
    ContactSolveSettings settings = kSolve;
    settings.Soften(60, 10, 1.0f / 240, 3);
    EXPECT_NEAR(settings.massScale, 1 / (1 + gamma), 1e-6);
    EXPECT_NEAR(settings.impulseScale, gamma / (1 + gamma), 1e-6);
    EXPECT_NEAR(settings.pushRate, beta / h, 1e-4);
}

TEST(MeanDistance, OfASquareIsItsClosedForm) {
    // Mean distance from the center of a square of half side 1: (sqrt 2 + ln(1 + sqrt 2)) / 3 = 0.7652.
    const float x[4] = {1, -1, -1, 1}, y[4] = {1, 1, -1, -1};
    EXPECT_NEAR(MeanDistance(x, y, 4), (std::sqrt(2.0) + std::log(1 + std::sqrt(2.0))) / 3, 1e-3);
    // Corners come in any order.
    const float u[4] = {1, -1, 1, -1}, v[4] = {1, -1, -1, 1};
    EXPECT_FLOAT_EQ(MeanDistance(u, v, 4), MeanDistance(x, y, 4));
}

TEST(MeanDistance, OfASegmentIsAQuarterOfItsLength) {
    const float x[2] = {-1.5f, 1.5f}, y[2] = {-2, 2};
    EXPECT_FLOAT_EQ(MeanDistance(x, y, 2), 5.0f / 4);
}

TEST(MeanDistance, OfAPointIsNothing) {
    const float x[1] = {0}, y[1] = {0};
    EXPECT_EQ(MeanDistance(x, y, 1), 0);
}

TEST(MeanDistance, OfATriangleScalesWithItsSize) {
    // Equilateral, circumradius 1, inner radius r = 1/2: two thirds of the mean of sqrt(r^2 + s^2), s from 0 to sqrt(3)
    // / 2.
    const float x[3] = {1, -0.5f, -0.5f},
                y[3] = {0, static_cast<float>(std::sqrt(0.75)), -static_cast<float>(std::sqrt(0.75))};
    const double r = 0.5, s = std::sqrt(0.75);
    const double edge = 0.5 * (s * std::sqrt(r * r + s * s) + r * r * std::asinh(s / r)) / s;
    EXPECT_NEAR(MeanDistance(x, y, 3), 2.0 / 3 * edge, 1e-2);
    const float x3[3] = {3 * x[0], 3 * x[1], 3 * x[2]}, y3[3] = {3 * y[0], 3 * y[1], 3 * y[2]};
    EXPECT_NEAR(MeanDistance(x3, y3, 3), 3 * MeanDistance(x, y, 3), 1e-6);
}

}  // namespace
}  // namespace fulcrum::testing
