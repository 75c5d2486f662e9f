#include <Fulcrum/Collision/NarrowPhase/BoxFaceContact.h>

#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>

namespace fulcrum {

namespace {

using Four = Wide<4>;

Four FourOf(float a, float b, float c, float d) { return Four::Of(Four::Float{a, b, c, d}); }

// The other box's face as a parallelogram over the reference face: middle and half sides in the coordinates (u, v)
// along the reference face and its separation w from the plane of it.
struct Parallelogram {
    float u, v, w;
    float u1, v1, w1;
    float u2, v2, w2;
};

// The reference box's frame: which of its axes is the normal, and the two others in cyclic order.
struct FaceFrame {
    int normal, u, v;
    float side;  // +1 or -1: the face's place on the normal axis
};

// Vertex and edge numbers of the four corners of a box face, counter-clockwise in its two axes from the corner (+, +).
struct FaceCorners {
    uint32_t vertices[4];

    FaceCorners(int normal, bool positive, int first, int second) {
        const uint32_t base = positive ? 1u << normal : 0u, p = 1u << first, q = 1u << second;
        vertices[0] = base | p | q;
        vertices[1] = base | q;
        vertices[2] = base;
        vertices[3] = base | p;
    }
    // Edge k starts at corner k.
    uint32_t Edge(int k) const { return EdgeName(vertices[k], vertices[(k + 1) & 3]); }
};

// Where a candidate comes from: the kind and number of a side or corner. Its feature id is computed only if it is
// chosen.
struct Origin {
    enum Kind : uint8_t { SideEnters, SideLeaves, IncidentCorner, ReferenceCorner };
    uint8_t number;
    Kind kind;
    bool byU, upper;  // the bound of the rectangle that cuts the side
};

struct Candidates {
    FlatPoints<16> points;  // at most 12 are used: two per side, and the corners of the rectangle
    Origin origins[16];

    void Add(float u, float v, float w, Origin origin) {
        origins[points.count] = origin;
        points.Add(u, v, w);
    }
};

uint32_t FeatureOf(const Origin& origin, const FaceCorners& reference, const FaceCorners& incident, bool referenceOfA) {
    if (origin.kind == Origin::ReferenceCorner) return VertexFeature(referenceOfA, reference.vertices[origin.number]);
    if (origin.kind == Origin::IncidentCorner) return VertexFeature(!referenceOfA, incident.vertices[origin.number]);
    // Sides start at the corners (+,+), (-,+), (-,-), (+,-).
    const int cut = origin.byU ? (origin.upper ? 3 : 1) : (origin.upper ? 0 : 2);
    const uint32_t r = reference.Edge(cut), i = incident.Edge(origin.number);
    return referenceOfA ? CrossingFeature(r, i) : CrossingFeature(i, r);
}

// Like ClippedFeature.h, but specialized to a parallelogram and a rectangle, in lanes: with the general code
// large_pyramid takes 6 % more instructions.

// The sides of the parallelogram are cut by the reference rectangle, all four at once (Y. Liang and B. Barsky, A New
// Concept and Method for Line Clipping, ACM TOG 3(1), 1984). The rectangle is larger by the slop, so that sides that
// lie on each other stay whole under tiny motions. Each side gives its entry point, if cut there, and its exit or end.
void AddCutSides(const Parallelogram& p, float halfU, float halfV, float slop, float reach, Candidates& out) {
    const Four sign1 = FourOf(1, -1, -1, 1), sign2 = FourOf(1, 1, -1, -1);
    const Four u = Four(p.u) + sign1 * Four(p.u1) + sign2 * Four(p.u2);
    const Four v = Four(p.v) + sign1 * Four(p.v1) + sign2 * Four(p.v2);
    const Four w = Four(p.w) + sign1 * Four(p.w1) + sign2 * Four(p.w2);
    // From corner k to the next: -2 along the first side, -2 along the second, and back.
    const Four step1 = FourOf(-2, 0, 2, 0), step2 = FourOf(0, -2, 0, 2);
    const Four du = step1 * Four(p.u1) + step2 * Four(p.u2), dv = step1 * Four(p.v1) + step2 * Four(p.v2);
    const Four dw = step1 * Four(p.w1) + step2 * Four(p.w2);

    const auto notZero = [](Four x) { return Select(Abs(x) < Four(1e-12f), Four(1e-12f), x); };
    const Four perU = Four(1.0f) / notZero(du), perV = Four(1.0f) / notZero(dv);
    const Four limitU(halfU + slop), limitV(halfV + slop);
    const Four ta = (limitU - u) * perU, tb = (-limitU - u) * perU, tc = (limitV - v) * perV, td = (-limitV - v) * perV;
    const Four inU = Min(ta, tb), outU = Max(ta, tb), inV = Min(tc, td), outV = Max(tc, td);
    const Four enter = Max(Max(inU, inV), Four(0.0f)), leave = Min(Min(outU, outV), Four(1.0f));
    const uint32_t crosses = (enter <= leave).ToBits();
    if (crosses == 0) return;
    const uint32_t entersLate = crosses & (enter > Four(0.0f)).ToBits();
    const uint32_t entersByU = (inU >= inV).ToBits(), leavesByU = (outU <= outV).ToBits();
    const uint32_t reachesEnd = (leave >= Four(1.0f)).ToBits();
    const uint32_t upwardsU = (du > Four(0.0f)).ToBits(), upwardsV = (dv > Four(0.0f)).ToBits();

    float us[2][4], vs[2][4], ws[2][4];
    (u + du * enter).Store(us[0]);
    (v + dv * enter).Store(vs[0]);
    const Four wEnter = w + dw * enter, wLeave = w + dw * leave;
    wEnter.Store(ws[0]);
    (u + du * leave).Store(us[1]);
    (v + dv * leave).Store(vs[1]);
    wLeave.Store(ws[1]);
    const uint32_t nearEnter = (wEnter <= Four(reach)).ToBits(), nearLeave = (wLeave <= Four(reach)).ToBits();

    for (uint32_t left = crosses & (nearEnter & entersLate); left != 0; left &= left - 1) {
        const int k = __builtin_ctz(left);
        const bool byU = entersByU >> k & 1, upwards = ((entersByU & upwardsU) | (~entersByU & upwardsV)) >> k & 1;
        out.Add(us[0][k], vs[0][k], ws[0][k], {static_cast<uint8_t>(k), Origin::SideEnters, byU, !upwards});
    }
    for (uint32_t left = crosses & nearLeave; left != 0; left &= left - 1) {
        const int k = __builtin_ctz(left);
        const bool byU = leavesByU >> k & 1, upwards = ((leavesByU & upwardsU) | (~leavesByU & upwardsV)) >> k & 1;
        const bool ends = reachesEnd >> k & 1;
        out.Add(us[1][k], vs[1][k], ws[1][k],
                {static_cast<uint8_t>(ends ? (k + 1) & 3 : k), ends ? Origin::IncidentCorner : Origin::SideLeaves, byU,
                 upwards});
    }
}

// The corners of the reference rectangle that lie inside the parallelogram by more than the slop.
void AddCoveredCorners(const Parallelogram& p, float halfU, float halfV, float slop, float reach, Candidates& out) {
    const float determinant = p.u1 * p.v2 - p.u2 * p.v1;
    if (Abs(determinant) <= 1e-12f * (halfU * halfV)) return;  // degenerate: seen edge on
    const float scale = 1.0f / determinant;
    const Four u = FourOf(halfU, -halfU, -halfU, halfU), v = FourOf(halfV, halfV, -halfV, -halfV);
    const Four du = u - Four(p.u), dv = v - Four(p.v);
    const Four along1 = (du * Four(p.v2) - dv * Four(p.u2)) * Four(scale);
    const Four along2 = (dv * Four(p.u1) - du * Four(p.v1)) * Four(scale);
    // The slop is measured along the height of the parallelogram over a side, |determinant| / |side|.
    const float margin1 = 1.0f - slop * Sqrt(p.u2 * p.u2 + p.v2 * p.v2) * Abs(scale);
    const float margin2 = 1.0f - slop * Sqrt(p.u1 * p.u1 + p.v1 * p.v1) * Abs(scale);
    const Four w = Four(p.w) + along1 * Four(p.w1) + along2 * Four(p.w2);
    const uint32_t covered =
        ((Abs(along1) < Four(margin1)) & (Abs(along2) < Four(margin2)) & (w <= Four(reach))).ToBits();
    for (uint32_t left = covered; left != 0; left &= left - 1) {
        const int k = __builtin_ctz(left);
        out.Add(k == 0 || k == 3 ? halfU : -halfU, k < 2 ? halfV : -halfV, w[k],
                {static_cast<uint8_t>(k), Origin::ReferenceCorner, false, false});
    }
}

// A face of A or B, and the direction to the other box, in the frame of the face's box.
struct ReferenceBoxFace {
    bool ofA;
    int face;
    Vector3 direction;  // unit
    float slop;         // m: enlargement of the face
};

// Projected along the direction onto the face's plane; w becomes the distance along the direction.
Parallelogram Projected(const Parallelogram& p, const FaceFrame& frame, const Vector3& direction) {
    const float perHeight = frame.side / direction[frame.normal];
    const float du = direction[frame.u] * perHeight, dv = direction[frame.v] * perHeight;
    return {p.u - du * p.w,   p.v - dv * p.w,   p.w * perHeight,  p.u1 - du * p.w1, p.v1 - dv * p.w1,
            p.w1 * perHeight, p.u2 - du * p.w2, p.v2 - dv * p.w2, p.w2 * perHeight};
}

bool BuildContact(const BoxPair& pair, const ReferenceBoxFace& seen, float separation,
                  const ContactTolerances& tolerances, Manifold& manifold) {
    const int face = seen.face;
    const bool ofA = seen.ofA;
    const FaceFrame frame{face / 2, (face / 2 + 1) % 3, (face / 2 + 2) % 3, face % 2 == 0 ? 1.0f : -1.0f};
    const Vector3& half = ofA ? pair.halfA : pair.halfB;
    const Vector3& otherHalf = ofA ? pair.halfB : pair.halfA;
    const Matrix3& axes = ofA ? pair.rotation : pair.transposed;  // the other box's, in this box's frame
    const Vector3 otherCenter = ofA ? pair.position : Vector3(-pair.positionInB);

    // The other box's face that points most nearly against the direction.
    const float cosines[3] = {Dot(axes.x, seen.direction), Dot(axes.y, seen.direction), Dot(axes.z, seen.direction)};
    int m = Abs(cosines[1]) > Abs(cosines[0]) ? 1 : 0;
    if (Abs(cosines[2]) > Abs(cosines[m])) m = 2;
    const int m1 = (m + 1) % 3, m2 = (m + 2) % 3;
    const bool positive = cosines[m] < 0.0f;
    const Vector3* columns = &axes.x;
    const Vector3 middle = otherCenter + columns[m] * (positive ? otherHalf[m] : -otherHalf[m]);
    const Vector3 side1 = columns[m1] * otherHalf[m1], side2 = columns[m2] * otherHalf[m2];
    const Parallelogram p =
        Projected({middle[frame.u], middle[frame.v], middle[frame.normal] * frame.side - half[frame.normal],
                   side1[frame.u], side1[frame.v], side1[frame.normal] * frame.side, side2[frame.u], side2[frame.v],
                   side2[frame.normal] * frame.side},
                  frame, seen.direction);

    const FaceCorners reference(frame.normal, frame.side > 0, frame.u, frame.v), incident(m, positive, m1, m2);
    Candidates found;
    AddCutSides(p, half[frame.u], half[frame.v], seen.slop, tolerances.reach, found);
    AddCoveredCorners(p, half[frame.u], half[frame.v], tolerances.prefer, tolerances.reach, found);
    FlatPoints<16>& points = found.points;
    float least = std::numeric_limits<float>::infinity();
    for (int i = 0; i < points.count; ++i) least = Min(least, points.separation[i]);
    if (!(least <= separation + tolerances.prefer)) return false;

    int chosen[4];
    const int count = ChooseFour(points, tolerances.prefer, chosen, tolerances.Weights());
    static const Matrix3 kOwn{Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)};
    const Vector3* own = ofA ? &kOwn.x : &pair.rotation.x;  // this box's axes in A's frame
    const Vector3 normal = own[0] * seen.direction[0] + own[1] * seen.direction[1] + own[2] * seen.direction[2];
    const Vector3 plane =
        (ofA ? Vector3(Vector3::Zero()) : pair.position) + own[frame.normal] * (frame.side * half[frame.normal]);
    manifold.normal = ofA ? normal : Vector3(-normal);
    manifold.pointCount = count;
    for (int i = 0; i < count; ++i) {
        const int c = chosen[i];
        const float w = points.separation[c];
        const float aboveCore = ofA ? pair.radiusA : w - pair.radiusA;  // of A's surface over this box's core
        ManifoldPoint& point = manifold.points[i];
        point.positionOnA = plane + own[frame.u] * points.u[c] + own[frame.v] * points.v[c] + normal * aboveCore;
        point.separation = w - (pair.radiusA + pair.radiusB);
        point.feature = FeatureOf(found.origins[c], reference, incident, ofA);
    }
    return true;
}

}  // namespace

bool BuildBoxFaceContact(const BoxPair& pair, bool ofA, int face, float separation, const ContactTolerances& tolerances,
                         Manifold& manifold) {
    Vector3 direction = Vector3::Zero();
    direction[face / 2] = face % 2 == 0 ? 1.0f : -1.0f;
    return BuildContact(pair, {ofA, face, direction, tolerances.prefer}, separation, tolerances, manifold);
}

bool BuildBoxAxisContact(const BoxPair& pair, const Vector3& axis, float separation,
                         const ContactTolerances& tolerances, Manifold& manifold) {
    const Vector3 steepness = axis.cwiseAbs();
    int m = steepness.y() > steepness.x() ? 1 : 0;
    if (steepness.z() > steepness[m]) m = 2;
    return BuildContact(pair, {true, 2 * m + (axis[m] < 0 ? 1 : 0), axis, 0}, separation, tolerances, manifold);
}

}  // namespace fulcrum
