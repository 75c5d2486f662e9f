// The rows of one lane are replaced within the step: they have the separations of the bodies' current poses, the warm
// start becomes theirs, and the other lanes do not change by a bit.
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/UnitTests/Constraints/Contacts/RandomContacts.h>

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr ContactPrepareSettings kPrepare{1.0f, 0.5f};

// Gives all bodies but static ones a displacement, of which the rotation is far from small.
void Displace(RandomContacts& contacts, uint32_t seed) {
    RandomPoses random(seed);
    for (size_t i = 0; i < contacts.states.size(); ++i) {
        if (contacts.masses[i].inverseMass == 0) continue;
        const Vector3 moved = random.InBox(0.05f), turned = random.InBox(0.4f);
        for (int k = 0; k < 3; ++k) {
            contacts.states[i].deltaPosition[k] = moved[k];
            contacts.states[i].deltaRotation[k] = turned[k];
        }
    }
}

// The poses of two bodies at their displacements.
struct Pair {
    BodyState states[2];
    BodyMass masses[2];
    BodyPose poses[2];

    Pair(const RandomContacts& contacts, uint32_t bodyA) {
        for (uint32_t i = 0; i < 2; ++i) {
            states[i] = contacts.states[bodyA + i];
            masses[i] = contacts.masses[bodyA + i];
            poses[i] = contacts.poses[bodyA + i];
            const Twist<float> moved = contacts.DisplacementOf(bodyA + i);
            const Quaternion q = Normalized(RotationFromVector(moved.angular) * contacts.PoseOf(bodyA + i).rotation);
            const float rotation[4] = {q.x, q.y, q.z, q.w};
            for (int k = 0; k < 4; ++k) poses[i].rotation[k] = rotation[k];
            for (int k = 0; k < 3; ++k) poses[i].position[k] += double{moved.linear[k]};
        }
    }
    // m, of a point of the record.
    float SeparationOf(const ContactRecord& record, int point) const {
        const auto at = [&](int body, const float(&p)[3]) {
            const float* q = poses[body].rotation;
            const Vector3 arm = Rotate(Quaternion{q[0], q[1], q[2], q[3]}, Vector3(p[0], p[1], p[2]));
            const double* center = poses[body].position;
            return Position(center[0], center[1], center[2]) + arm.cast<double>();
        };
        const float* q = poses[0].rotation;
        const Vector3 normal =
            Rotate(Quaternion{q[0], q[1], q[2], q[3]}, Vector3(record.normal[0], record.normal[1], record.normal[2]));
        const ContactRecord::Point& p = record.points[point];
        return Dot<float>(normal, Vector3((at(1, p.onB) - at(0, p.onA)).cast<float>()));
    }
};

template <bool kFixedB>
void ExpectRefill(uint32_t seed) {
    constexpr int N = kLanes;
    RandomContacts contacts(N, kFixedB, seed);
    for (ContactRecord& record : contacts.records) record.restitution = 0;
    // A kinematic body would move.
    if (kFixedB)
        for (uint32_t i = 1; i < contacts.states.size(); i += 2) contacts.states[i] = {};
    auto batch = PrepareBatch<N, kFixedB>(contacts, 0, kPrepare);
    Displace(contacts, seed);
    ContactSolveSettings settings{
        .inverseDt = 240.0f, .elapsed = 0.01f, .pushRate = 0, .massScale = 0, .impulseScale = 0, .slop = 0};
    settings.Soften(60, 10, 1.0f / 240, 3);
    UpdateSeparations(batch, contacts.states.data(), settings);
    const auto unchanged = batch;
    const int lane = static_cast<int>(seed) % N;
    const uint32_t bodyA = 2 * static_cast<uint32_t>(lane);
    ContactRecord& record = contacts.records[static_cast<size_t>(lane)];
    record.pointCount = static_cast<float>(1 + seed % ContactRecord::kMaxPoints);
    for (int i = 0; i < ContactRecord::kMaxPoints; ++i) {
        if (i >= static_cast<int>(record.pointCount)) record.impulse[i] = 0;
        else if (record.impulse[i] == 0) record.points[i] = record.points[0];
    }
    const Pair pair(contacts, bodyA);
    float free[2][8] = {};
    RefillContact(batch, lane, contacts.records.data(), {pair.states, pair.masses, pair.poses}, free[0],
                  kFixedB ? nullptr : free[1], kPrepare, 0.01f);

    // Its rows, at the current displacements.
    UpdateSeparations(batch, contacts.states.data(), settings);
    for (int i = 0; i < static_cast<int>(record.pointCount); ++i)
        EXPECT_NEAR(batch.rows[i].separation[lane], pair.SeparationOf(record, i), 1e-5f) << "point " << i;
    for (int i = static_cast<int>(record.pointCount); i < batch.pointCount; ++i)
        EXPECT_EQ(batch.rows[i].inverseResponse[lane], 0) << "point " << i;
    EXPECT_EQ(batch.collisions[lane], 2);
    // The warm start of both bodies changes by opposite momenta.
    if constexpr (!kFixedB) {
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(free[0][k] / pair.masses[0].inverseMass, -free[1][k] / pair.masses[1].inverseMass, 1e-3f);
    }
    // Other lanes move their bodies as before.
    RandomContacts a = contacts, b = contacts;
    auto before = unchanged;
    SolveContactVelocities(before, a.states.data(), settings);
    SolveContactVelocities(batch, b.states.data(), settings);
    for (uint32_t i = 0; i < a.states.size(); ++i) {
        if (i == bodyA || i == bodyA + 1) continue;
        EXPECT_EQ(std::memcmp(&a.states[i], &b.states[i], sizeof(BodyState)), 0) << "body " << i;
    }
}

TEST(RefillContact, ReplacesTheRowsOfOneLane) {
    for (uint32_t seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        ExpectRefill<false>(seed);
        ExpectRefill<true>(seed);
    }
}

// Bodies after contacts, solved in batches of N, of which one gets a restitution within the step.
template <int N>
std::vector<BodyState> WithRestitutionLater(uint32_t seed, float restitution) {
    RandomContacts contacts(kLanes, false, seed);
    const uint32_t bouncing = seed % kLanes;
    for (ContactRecord& record : contacts.records) record.restitution = 0;
    const RareContactData rare = contacts.Rare();
    ContactSolveSettings settings{
        .inverseDt = 240.0f, .elapsed = 0.01f, .pushRate = 0, .massScale = 0, .impulseScale = 0, .slop = 0};
    settings.Soften(60, 10, 1.0f / 240, 3);
    settings.restitutionSpeed = 0.1f;
    settings.rare = &rare;
    for (uint32_t first = 0; first < kLanes; first += N) {
        auto batch = PrepareBatch<N, false>(contacts, first, kPrepare);
        if (bouncing >= first && bouncing < first + N) {
            contacts.records[bouncing].restitution = restitution;
            const Pair pair(contacts, 2 * bouncing);
            float free[2][8] = {};
            RefillContact(batch, static_cast<int>(bouncing - first), contacts.records.data(),
                          {pair.states, pair.masses, pair.poses}, free[0], free[1], kPrepare, 0.01f);
        }
        SolveContactVelocities(batch, contacts.states.data(), settings);
        RelaxContacts(batch, contacts.states.data(), settings);
    }
    return contacts.states;
}

TEST(RefillContact, GivesALaneRestitutionWhereNoOtherHasAny) {
    int bounced = 0;
    for (uint32_t seed = 1; seed <= 40; ++seed) {
        const auto one = WithRestitutionLater<1>(seed, 0.9f), all = WithRestitutionLater<kLanes>(seed, 0.9f),
                   none = WithRestitutionLater<kLanes>(seed, 0);
        for (size_t i = 0; i < one.size(); ++i)
            EXPECT_EQ(std::memcmp(&one[i], &all[i], sizeof(BodyState)), 0) << "seed " << seed << ", body " << i;
        bounced += std::memcmp(&all[2 * (seed % kLanes)], &none[2 * (seed % kLanes)], sizeof(BodyState)) != 0;
    }
    EXPECT_GT(bounced, 10);  // the other bodies part
}

// A contact that was not found again no longer acts.
TEST(RefillContact, OfBodiesThatAreApartActsNoMore) {
    RandomContacts contacts(kLanes, false, 1);
    for (ContactRecord& record : contacts.records) record.restitution = 0;
    auto batch = PrepareBatch<kLanes, false>(contacts, 0, kPrepare);
    contacts.records[0].Set(ContactRecord::kApart, true);
    const Pair pair(contacts, 0);
    float free[2][8] = {};
    RefillContact(batch, 0, contacts.records.data(), {pair.states, pair.masses, pair.poses}, free[0], free[1], kPrepare,
                  0.01f);
    ContactSolveSettings settings{
        .inverseDt = 240.0f, .elapsed = 0.01f, .pushRate = 0, .massScale = 0, .impulseScale = 0, .slop = 0};
    settings.Soften(60, 10, 1.0f / 240, 3);
    const RandomContacts before = contacts;
    SolveContactVelocities(batch, contacts.states.data(), settings);
    for (int body = 0; body < 2; ++body)
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(contacts.states[static_cast<size_t>(body)].linearVelocity[k],
                      before.states[static_cast<size_t>(body)].linearVelocity[k]);
            EXPECT_NE(free[body][k], 0);  // the load that it carried is no longer warm started
        }
}

}  // namespace
}  // namespace fulcrum::testing
