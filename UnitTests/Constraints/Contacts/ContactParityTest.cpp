// Contacts solved one by one and in lanes: the same bits, contact by contact.
#include <Fulcrum/Constraints/Contacts/ContactNote.h>
#include <Fulcrum/UnitTests/Constraints/Contacts/RandomContacts.h>

#include <gtest/gtest.h>

#include <cstring>

namespace fulcrum::testing {
namespace {

constexpr uint32_t kContacts = 61;  // no multiple of any number of lanes

// Every third contact has a surface that moves.
void MoveSurfaces(RandomContacts& contacts, uint32_t seed) {
    RandomPoses random(seed);
    for (size_t i = 0; i < contacts.records.size(); i += 3) {
        const Vector3 linear = random.InBox(2.0f), angular = random.InBox(2.0f);
        contacts.records[i].Set(ContactRecord::kSurfaceVelocity, true);
        contacts.surfaceVelocities[i] = {{linear[0], linear[1], linear[2]}, {angular[0], angular[1], angular[2]}};
    }
}

struct NotedContacts : RandomContacts {
    using RandomContacts::RandomContacts;
    std::vector<ContactNote> notes;
};

// The whole life of contacts over two substeps.
template <int N, bool kFixedB>
NotedContacts Solved(uint32_t seed, bool surfacesMove) {
    NotedContacts contacts(kContacts, kFixedB, seed);
    contacts.notes.resize(kContacts);
    if (surfacesMove) MoveSurfaces(contacts, seed);
    BodyState* states = contacts.states.data();
    for (uint32_t first = 0; first < kContacts; first += N) {
        auto batch = PrepareBatch<N, kFixedB>(contacts, first, {0.9f, 0.5f});
        ContactSolveSettings settings{
            .inverseDt = 240.0f, .elapsed = 0, .pushRate = 0, .massScale = 0, .impulseScale = 0, .slop = 0.0005f};
        settings.restitutionSpeed = 0.5f;
        settings.notes = contacts.notes.data();
        const RareContactData rare = contacts.Rare();
        settings.rare = &rare;
        batch.hasNotes = true;
        BeginNotes(batch, contacts.Bodies(), contacts.notes.data());
        settings.Soften(60, 10, 1.0f / 240, 3);
        WarmStartContacts(batch, states);
        for (int substep = 1; substep <= 2; ++substep) {
            settings.elapsed = static_cast<float>(substep) / 240.0f;
            SolveContactVelocities(batch, states, settings);
            SolveContactVelocities(batch, states, settings);
            for (int lane = 0; lane < batch.count; ++lane)
                for (uint32_t body = batch.bodyA[lane]; body < batch.bodyA[lane] + (kFixedB ? 1 : 2); ++body)
                    for (int k = 0; k < 3; ++k) {
                        states[body].deltaPosition[k] += states[body].linearVelocity[k] / 240.0f;
                        states[body].deltaRotation[k] += states[body].angularVelocity[k] / 240.0f;
                    }
            RelaxContacts(batch, states, settings);
            AddRowImpulses(batch, contacts.notes.data());
        }
        StoreContacts(batch, contacts.records.data());
    }
    // What is noted of points that only other contacts of the batch have is nobody's.
    for (size_t i = 0; i < kContacts; ++i)
        for (int k = static_cast<int>(contacts.records[i].pointCount); k < ContactNote::kMaxPoints; ++k)
            contacts.notes[i].approachSpeed[k] = 0;
    return contacts;
}

template <bool kFixedB>
void ExpectSameBits(const NotedContacts& a, const NotedContacts& b, const char* lanes) {
    for (size_t i = 0; i < a.states.size(); ++i)
        ASSERT_EQ(std::memcmp(&a.states[i], &b.states[i], sizeof(BodyState)), 0) << lanes << ", body " << i;
    for (size_t i = 0; i < a.records.size(); ++i)
        ASSERT_EQ(std::memcmp(&a.records[i], &b.records[i], sizeof(ContactRecord)), 0) << lanes << ", contact " << i;
    for (size_t i = 0; i < a.notes.size(); ++i)
        ASSERT_EQ(std::memcmp(&a.notes[i], &b.notes[i], sizeof(ContactNote)), 0) << lanes << ", contact " << i;
}

template <bool kFixedB>
void ExpectParity(uint32_t seed, bool surfacesMove = false) {
    const NotedContacts one = Solved<1, kFixedB>(seed, surfacesMove);
    ExpectSameBits<kFixedB>(one, Solved<kLanes, kFixedB>(seed, surfacesMove), kSimdName);
}

TEST(ContactParity, OfTwoMovingBodies) {
    for (uint32_t seed = 1; seed <= 20; ++seed) ExpectParity<false>(seed);
}

TEST(ContactParity, OfAMovingAndAFixedBody) {
    for (uint32_t seed = 1; seed <= 20; ++seed) ExpectParity<true>(seed);
}

TEST(ContactParity, OfSurfacesThatMove) {
    for (uint32_t seed = 1; seed <= 20; ++seed) {
        ExpectParity<false>(seed, true);
        ExpectParity<true>(seed, true);
    }
}

}  // namespace
}  // namespace fulcrum::testing
