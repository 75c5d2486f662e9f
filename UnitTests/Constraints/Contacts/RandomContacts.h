// Random bodies in contact, as input of the solver, for the tests of the contact kernels.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactBatch.h>
#include <Fulcrum/Math/Pose.h>
#include <Fulcrum/UnitTests/Constraints/Parts/RandomBodies.h>

#include <vector>

namespace fulcrum::testing {

// Contact i is between body 2 i and body 2 i + 1, a meter or so apart, with 1 to 4 points.
struct RandomContacts {
    std::vector<BodyState> states;
    std::vector<BodyMass> masses;
    std::vector<BodyPose> poses;
    std::vector<ContactRecord> records;
    std::vector<SurfaceVelocity> surfaceVelocities;  // by record, zero

    // fixedB: the second bodies have no mass.
    RandomContacts(uint32_t count, bool fixedB, uint32_t seed) {
        RandomPoses random(seed);
        for (uint32_t i = 0; i < count; ++i) {
            const Vector3 place = random.InBox(5.0f);
            AddBody(random, place, false);
            AddBody(random, Vector3(place + AnyDirection(random)), fixedB);
            AddRecord(random, 2 * i);
        }
    }

    SolverBodies Bodies() { return {states.data(), masses.data(), poses.data()}; }
    RareContactData Rare() const { return {records.data(), poses.data(), surfaceVelocities.data()}; }

    InverseMass<float> MassOf(uint32_t body) const {
        const float* m = masses[body].Row();
        return {m[6], {m[0], m[1], m[2], m[3], m[4], m[5]}};
    }
    Twist<float> VelocityOf(uint32_t body) const {
        const BodyState& s = states[body];
        return {Vector3(s.linearVelocity[0], s.linearVelocity[1], s.linearVelocity[2]),
                Vector3(s.angularVelocity[0], s.angularVelocity[1], s.angularVelocity[2])};
    }
    Twist<float> DisplacementOf(uint32_t body) const {
        const BodyState& s = states[body];
        return {Vector3(s.deltaPosition[0], s.deltaPosition[1], s.deltaPosition[2]),
                Vector3(s.deltaRotation[0], s.deltaRotation[1], s.deltaRotation[2])};
    }
    Pose PoseOf(uint32_t body) const {
        const BodyPose& p = poses[body];
        return {Position(p.position[0], p.position[1], p.position[2]),
                {p.rotation[0], p.rotation[1], p.rotation[2], p.rotation[3]}};
    }

private:
    void AddBody(RandomPoses& random, const Vector3& place, bool fixed) {
        const RandomBody body = MakeBody(random);
        BodyState state;
        BodyMass mass;
        BodyPose pose;
        for (int k = 0; k < 3; ++k) {
            state.linearVelocity[k] = body.velocity.linear[k];
            state.angularVelocity[k] = body.velocity.angular[k];
            pose.position[k] = double(place[k]);
        }
        if (!fixed) {
            const auto& i = body.mass.inertia;
            const float rows[6] = {i.xx, i.yy, i.zz, i.xy, i.xz, i.yz};
            for (int k = 0; k < 6; ++k) mass.inverseInertia[k] = rows[k];
            mass.inverseMass = body.mass.mass.x();
            pose.acceleration[1] = -9.81f;
        }
        const Vector3 axis = AnyDirection(random);
        const float w = random.Between(-1.0f, 1.0f);
        const Quaternion q = Normalized(Quaternion{axis.x(), axis.y(), axis.z(), w});
        const float rotation[4] = {q.x, q.y, q.z, q.w};
        for (int k = 0; k < 4; ++k) pose.rotation[k] = rotation[k];
        states.push_back(state);
        masses.push_back(mass);
        poses.push_back(pose);
    }

    void AddRecord(RandomPoses& random, uint32_t bodyA) {
        const Pose a = PoseOf(bodyA), b = PoseOf(bodyA + 1);
        const Vector3 between((b.position - a.position).cast<float>());
        const Vector3 normal = Normalized(between), t1 = Perpendicular(normal), t2 = Cross<float>(normal, t1);
        const Vector3 inA = InverseRotate(a.rotation, normal);
        ContactRecord record;
        const int count = 1 + static_cast<int>(random.Between(0.0f, 3.999f));
        record.pointCount = static_cast<float>(count);
        record.friction = random.Between(0.0f, 1.0f);
        record.restitution = random.Chance(0.5f) ? random.Between(0.0f, 1.0f) : 0.0f;
        record.twistRadius = random.Between(0.0f, 0.5f);
        for (int i = 0; i < count; ++i) {
            const float u = random.Between(-0.5f, 0.5f), v = random.Between(-0.5f, 0.5f),
                        gap = random.Between(-0.02f, 0.02f);
            const Vector3 armA = normal * 0.5f + t1 * u + t2 * v;
            const Vector3 onA = InverseRotate(a.rotation, armA);
            const Vector3 onB = InverseRotate(b.rotation, Vector3(armA + normal * gap - between));
            for (int k = 0; k < 3; ++k) {
                record.points[i].onA[k] = onA[k];
                record.points[i].onB[k] = onB[k];
            }
            record.impulse[i] = random.Between(0.0f, 1.0f);
        }
        for (int k = 0; k < 3; ++k) record.normal[k] = inA[k];
        const Vector3 friction = t1 * random.Between(-0.3f, 0.3f);
        for (int k = 0; k < 3; ++k) record.frictionImpulse[k] = friction[k];
        record.twistImpulse = random.Between(-0.1f, 0.1f);
        records.push_back(record);
        surfaceVelocities.emplace_back();
    }
};

// Fills a batch with the contacts first .. first + N - 1; lanes beyond the last repeat it.
template <int N, bool kFixedB>
ContactBatch<N, kFixedB> PrepareBatch(RandomContacts& contacts, uint32_t first, ContactPrepareSettings settings) {
    ContactBatch<N, kFixedB> batch;
    const uint32_t left = static_cast<uint32_t>(contacts.records.size()) - first;
    batch.count = static_cast<int32_t>(left < N ? left : N);
    settings.surfaceVelocities = contacts.surfaceVelocities.data();
    for (uint32_t lane = 0; lane < N; ++lane) {
        const uint32_t used = lane < left ? lane : left - 1;
        batch.contact[lane] = first + used;
        batch.bodyA[lane] = 2 * (first + used);
        batch.bodyB[lane] = 2 * (first + used) + 1;
    }
    PrepareContacts<N, kFixedB>(batch, contacts.records.data(), contacts.Bodies(), settings);
    return batch;
}

}  // namespace fulcrum::testing
