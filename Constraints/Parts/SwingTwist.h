// The rotation of one joint frame against another as a swing of its x axis and a twist about it, and the errors of
// their limits. Called by joints once a step. Free functions, no state.
//
//   q      rotation of frame B relative to frame A, q = swing twist (twist first)      x  the twist axis, of frame A
//   twist  about x, by tau in -pi..pi                  d = swing x    the twist axis of frame B, seen from frame A
//   swing  about an axis e perpendicular to x, by alpha in 0..pi; phi = alpha e = (0, phi_y, phi_z)
//   With s = sqrt(x^2 + w^2) = cos(alpha / 2) of the components of q:
//          twist = (x, 0, 0, w) / s,      swing = (0, w y - x z, w z + x y, s^2) / s
//
// A limit is given by an error C, rad, >= 0 if satisfied, and a unit axis a with dC/dt = a . w, w the angular velocity
// of B relative to A; a is in frame A, like everything here. Own derivation.
//
// Swing limits bound a region of the sphere of directions d. C is the distance on the sphere from d to its edge: it is
// continuous everywhere, 180 degrees included, and its derivative is exactly of length 1. With D the nearest point of
// the edge and n the unit tangent vector of the sphere there that points inwards, C = atan2(d . n, d . D) and a = D x
// n.
//     cone      the circle alpha = c about x, so C = c - alpha, a = -e
//     ellipse   phi_y^2 / Y^2 + phi_z^2 / Z^2 = 1. phi is the map of the sphere that keeps distances and directions
//               from x. D is where d . dD/dt = 0 along the edge D(t), by bracketing
//     pyramid   swing_y / swing_w between tan(minimum / 2) and tan(maximum / 2), likewise z: on the main planes these
//               are angles. Its faces are circles through -x, so D is closed: the foot on a face, or a corner
//     one axis free, the other limited: the circles of latitude asin(d . its direction), a band of constant width. (The
//               edges above would degenerate at 180 degrees, which the free axis passes through.)
//     one axis locked, the other limited: d stays on a great circle, and lambda, its longitude there, in a range
//     both axes locked: phi = 0, in two rows along the great circle back to x, exact from any angle
// Twist: dtau/dt = t . w / cos(alpha / 2) with t = (x + d) / |x + d| = (s, swing_z, -swing_y), of length 1 up to 180
// degrees. Its C is the distance to the end of the range times cos(alpha / 2), with the axis t: exact at C = 0, to
// first order elsewhere. It vanishes where the x axes are opposite and twist is undefined. The longitude's C is scaled
// likewise by the cosine of latitude. Near 180 degrees t is nearly along the edge's a: a twist beyond its range and a
// swing beyond a range of 150 degrees or more then work against each other, and iterations over the rows converge
// slowly. Either alone is corrected at once.
#pragma once

#include <Fulcrum/Math/Trigonometry.h>

#include <array>
#include <cstdint>

namespace fulcrum {

enum class SwingShape : uint8_t { Ellipse, Pyramid };

// Radians, -pi <= minimum <= maximum <= pi. Locked if narrower than a hundredth of a degree, free if it excludes less
// than that of the full circle.
struct AngleRange {
    static constexpr float kHalfTurn = 3.14159265f;
    static constexpr float kNegligible = 1.7e-4f;

    float minimum = -kHalfTurn, maximum = kHalfTurn;

    bool IsLocked() const { return maximum - minimum < kNegligible; }
    bool IsFree() const { return maximum - minimum > 2.0f * kHalfTurn - kNegligible; }
    float Center() const { return 0.5f * (minimum + maximum); }
};

// The ranges of the swing contain 0 (a locked one is 0). The half angles of an ellipse are the maxima.
struct SwingTwistLimits {
    AngleRange twist, swingY, swingZ;
    SwingShape shape = SwingShape::Ellipse;
};

// See above. `slot` identifies a row of the joint from step to step.
struct RotationLimit {
    enum Slot : uint8_t { SwingYMaximum, SwingYMinimum, SwingZMaximum, SwingZMinimum, TwistMaximum, TwistMinimum };
    static constexpr int kSlots = 6;

    float error = 0.0f;              // C, rad
    Vector3 axis = Vector3::Zero();  // a
    Slot slot = SwingYMaximum;       // an ellipse uses SwingYMaximum
    bool isLocked = false;           // C = 0, in the slot of the maximum; else C >= 0
    // The edge is a circle about this unit vector, at least nearly, and a is across it and d. Zero if a is constant in
    // frame A.
    Vector3 pole = Vector3::Zero();
};

struct RotationLimitList {
    std::array<RotationLimit, RotationLimit::kSlots> limits;
    int count = 0;

    void Add(RotationLimit::Slot slot, float error, const Vector3& axis, bool isLocked = false,
             const Vector3& pole = Vector3::Zero()) {
        limits[count++] = {error, axis, slot, isLocked, pole};
    }
    const RotationLimit* begin() const { return limits.data(); }
    const RotationLimit* end() const { return limits.data() + count; }
};

// See above.
struct SwingTwist {
    Quaternion swing;                      // x is 0, w = cos(alpha / 2) >= 0
    float alpha = 0.0f;                    // rad, 0..pi
    float e1 = 1.0f, e2 = 0.0f;            // e = (0, e1, e2); (0, 1, 0) where alpha is 0
    float twist = 0.0f;                    // rad, -pi..pi
    Vector3 direction = Vector3(1, 0, 0);  // d

    float SwingY() const { return alpha * e1; }  // phi_y, rad
    float SwingZ() const { return alpha * e2; }
};

// q of length 1. At 180 degrees of swing the twist is undefined; it is set to 0.
inline SwingTwist Decompose(const Quaternion& q) {
    SwingTwist r;
    const float cosineHalf = Sqrt(q.x * q.x + q.w * q.w);
    if (cosineHalf > 1e-15f) {
        const float inverse = 1.0f / cosineHalf;
        r.swing = {0.0f, (q.w * q.y - q.x * q.z) * inverse, (q.w * q.z + q.x * q.y) * inverse, cosineHalf};
        // q and -q are the same rotation: the one with w >= 0 has a twist within half a revolution.
        r.twist = 2.0f * (q.w < 0.0f ? Atan2(-q.x, -q.w) : Atan2(q.x, q.w));
    } else {
        r.swing = {0.0f, q.y, q.z, 0.0f};
    }
    const float sineHalf = Sqrt(r.swing.y * r.swing.y + r.swing.z * r.swing.z);
    r.alpha = 2.0f * Atan2(sineHalf, r.swing.w);
    if (sineHalf > 1e-15f) {
        r.e1 = r.swing.y / sineHalf;
        r.e2 = r.swing.z / sineHalf;
    }
    const float w = r.swing.w, y = r.swing.y, z = r.swing.z;
    r.direction = Vector3(w * w - (y * y + z * z), 2.0f * (w * z), -2.0f * (w * y));
    return r;
}

namespace detail {

// Directions as (x, py, pz) with py = -z and pz = y: the directions to which rotations about +y and +z take x. This is
// a rotation of the coordinates about x, so cross products are preserved.
inline Vector3 ToSwingPlane(const Vector3& v) { return Vector3(v.x(), -v.z(), v.y()); }
inline Vector3 FromSwingPlane(const Vector3& v) { return Vector3(v.x(), v.z(), -v.y()); }

// The angle plus whole revolutions nearest to the center, both rad.
inline float Unwrapped(float angle, float center) {
    const float turn = 2.0f * AngleRange::kHalfTurn, apart = angle - center;
    return apart > AngleRange::kHalfTurn ? angle - turn : apart < -AngleRange::kHalfTurn ? angle + turn : angle;
}

// Adds both ends of the range of an angle that increases by rotation about the unit axis, at the rate 1 / scale.
inline void AddRange(RotationLimitList& list, RotationLimit::Slot slot, float angle, float scale, const Vector3& axis,
                     const AngleRange& range) {
    const float here = Unwrapped(angle, range.Center());
    if (range.IsLocked()) return list.Add(slot, scale * (here - range.Center()), axis, true);
    list.Add(slot, scale * (range.maximum - here), -axis);
    list.Add(static_cast<RotationLimit::Slot>(slot + 1), scale * (here - range.minimum), axis);
}

// A circle on the sphere, at the latitude `latitude` about the unit axis `pole`.
struct Circle {
    Vector3 pole;
    float latitude;  // rad
};
// The angular distance of d north of the circle, and the rotation axis that increases it. `across` is perpendicular to
// the pole and is used if d is a pole.
inline RotationLimit NorthOf(const Circle& circle, const Vector3& d, const Vector3& across) {
    RotationLimit limit;
    const Vector3 axis = Cross(d, circle.pole);
    const float cosine = Length(axis);
    limit.error = Atan2(Dot(circle.pole, d), cosine) - circle.latitude;
    limit.axis = cosine > 1e-6f ? Vector3(axis * (1.0f / cosine)) : across;
    limit.pole = circle.pole;
    return limit;
}

// The edge of the ellipse with the half axes Y, Z in 0..pi, in the swing plane's coordinates.
struct EllipseEdge {
    float halfY, halfZ;

    struct Point {
        Vector3 at, derivative;  // D and dD/dt at phi = (Y cos t, Z sin t)
    };
    Point At(const SineCosine<float>& t) const {
        const float y = halfY * t.cosine, z = halfZ * t.sine, dy = -(halfY * t.sine), dz = halfZ * t.cosine;
        const float alpha = Max(Sqrt(y * y + z * z), 1e-12f), inverse = 1.0f / alpha;
        const SineCosine<float> swing = SinCos(alpha);
        const float ey = y * inverse, ez = z * inverse, ratio = swing.sine * inverse;
        const float growth = ey * dy + ez * dz;  // dalpha/dt
        const float along = swing.cosine * growth;
        return {Vector3(swing.cosine, swing.sine * ey, swing.sine * ez),
                Vector3(-(swing.sine * growth), along * ey + ratio * (dy - growth * ey),
                        along * ez + ratio * (dz - growth * ez))};
    }

    // The point nearest to d, whose coordinates y and z are not negative; it is in the same quadrant, t in 0..pi/2.
    Point Nearest(const Vector3& d) const {
        // If the ellipse is curved more than the sphere there may be several local minima, so the search starts at the
        // best of a few samples.
        constexpr int kSamples = 6;
        constexpr float kStep = 0.5f * AngleRange::kHalfTurn / kSamples;
        constexpr float kSine[kSamples + 1] = {0.0f, 0.25881905f, 0.5f, 0.70710678f, 0.86602540f, 0.96592583f, 1.0f};
        const auto sample = [&](int i) { return At({kSine[i], kSine[kSamples - i]}); };
        int best = 0;
        float closest = -2.0f;
        for (int i = 0; i <= kSamples; ++i) {
            const float cosine = Dot(d, sample(i).at);
            if (cosine > closest) best = i, closest = cosine;
        }
        // d . D is maximal at the point: a root of its derivative d . dD/dt, by the Illinois method.
        Point point = sample(best);
        float slope = Dot(d, point.derivative);
        const int other = slope > 0.0f ? best + 1 : best - 1;
        if (other < 0 || other > kSamples) return point;
        float low = kStep * static_cast<float>(best), lowSlope = slope, high = kStep * static_cast<float>(other);
        float highSlope = Dot(d, sample(other).derivative);
        for (int i = 0; i < 12 && lowSlope * highSlope < 0.0f && Abs(slope) > kRounding; ++i) {
            const float t = (low * highSlope - high * lowSlope) / (highSlope - lowSlope);
            point = At(SinCos(t));
            slope = Dot(d, point.derivative);
            if (slope * highSlope < 0.0f) {
                low = high;
                lowSlope = highSlope;
            } else {
                lowSlope *= 0.5f;
            }
            high = t;
            highSlope = slope;
        }
        return point;
    }
    static constexpr float kRounding = 1e-7f;  // of derivatives
};

}  // namespace detail

// alpha <= halfAngle, 0..pi. At alpha = 0 the axis is -y, at 180 degrees it is that of the swing.
inline RotationLimit ConeLimit(const SwingTwist& r, float halfAngle) {
    return {halfAngle - r.alpha, Vector3(0.0f, -r.e1, -r.e2), RotationLimit::SwingYMaximum, false, Vector3(1, 0, 0)};
}

// halfY, halfZ > 0, < pi. Its error is at least the smaller one less alpha: not needed for joints far inside.
inline RotationLimit EllipseLimit(const SwingTwist& r, float halfY, float halfZ) {
    if (Abs(halfY - halfZ) < 1e-5f) return ConeLimit(r, halfY);
    const Vector3 d = detail::ToSwingPlane(r.direction);
    const float signY = d.y() < 0.0f ? -1.0f : 1.0f, signZ = d.z() < 0.0f ? -1.0f : 1.0f;
    const detail::EllipseEdge edge{halfY, halfZ};
    const detail::EllipseEdge::Point nearest = edge.Nearest(Vector3(d.x(), d.y() * signY, d.z() * signZ));
    // Mirrored back; the edge runs anticlockwise about x, so that D x tangent leads inwards, and a = D x (D x tangent).
    const Vector3 at(nearest.at.x(), nearest.at.y() * signY, nearest.at.z() * signZ);
    const Vector3 derivative =
        Vector3(nearest.derivative.x(), nearest.derivative.y() * signY, nearest.derivative.z() * signZ);
    const Vector3 tangent = Normalized(Vector3(derivative * (signY * signZ)));
    RotationLimit limit;
    limit.error = Atan2(Dot(d, Cross(at, tangent)), Dot(d, at));
    limit.axis = detail::FromSwingPlane(Vector3(-tangent));
    limit.pole = Normalized(Vector3(Vector3(1, 0, 0) - limit.axis * limit.axis.x()), Vector3(1, 0, 0));
    return limit;
}

namespace detail {

// The faces and corners of a pyramid, in the swing plane's coordinates.
struct Pyramid {
    AngleRange range[2];  // y, z

    // Face 0 and 1: maximum and minimum of y, 2 and 3 of z. North of the circle is beyond the maximum, or within the
    // minimum.
    Circle Face(int face) const {
        const float half = 0.5f * (face % 2 == 0 ? range[face / 2].maximum : range[face / 2].minimum);
        const SineCosine<float> angle = SinCos(half);
        return {Vector3(-angle.sine, face < 2 ? angle.cosine : 0.0f, face < 2 ? 0.0f : angle.cosine), half};
    }
    RotationLimit FaceLimit(int face, const Vector3& d) const {
        const Vector3 across =
            face < 2 ? Vector3(0, 0, -1) : Vector3(0, 1, 0);  // the y and z axes in these coordinates
        RotationLimit limit = NorthOf(Face(face), d, Vector3(-across));
        if (face % 2 == 0) limit = {-limit.error, -limit.axis, limit.slot, false, limit.pole};
        limit.slot = static_cast<RotationLimit::Slot>(face);
        return limit;
    }
    // Whether a point of a face's circle is between the other two faces.
    bool IsOnFace(int face, const Vector3& point) const {
        const AngleRange& other = range[1 - face / 2];
        const float along = face < 2 ? point.z() : point.y(), beyond = 1.0f + point.x();
        const SineCosine<float> high = SinCos(0.5f * other.maximum), low = SinCos(0.5f * other.minimum);
        return beyond > 1e-6f && along * high.cosine <= beyond * high.sine && along * low.cosine >= beyond * low.sine;
    }
    Vector3 Foot(int face, const Vector3& d) const {
        const Circle circle = Face(face);
        const SineCosine<float> latitude = SinCos(circle.latitude);
        const Vector3 flat = d - circle.pole * Dot(circle.pole, d);
        return circle.pole * latitude.sine + Normalized(flat, Vector3(1, 0, 0)) * latitude.cosine;
    }
    Vector3 Corner(int corner) const {
        const SineCosine<float> y = SinCos(0.5f * (corner % 2 == 0 ? range[0].maximum : range[0].minimum));
        const SineCosine<float> z = SinCos(0.5f * (corner / 2 == 0 ? range[1].maximum : range[1].minimum));
        // The swing's quaternion (w, y, z), not of length 1 but at least of 1e-4.
        const float a = y.cosine * z.cosine, b = y.sine * z.cosine, c = y.cosine * z.sine;
        const float squared = a * a + b * b + c * c;
        return Vector3(a * a - b * b - c * c, 2.0f * (a * b), 2.0f * (a * c)) * (1.0f / squared);
    }

    // Whether a swing is beyond a face. Tests its quaternion, because all the circles meet at -x.
    bool IsBeyond(int face, const Quaternion& swing) const {
        const SineCosine<float> half =
            SinCos(0.5f * (face % 2 == 0 ? range[face / 2].maximum : range[face / 2].minimum));
        const float over = (face < 2 ? swing.y : swing.z) * half.cosine - swing.w * half.sine;
        return face % 2 == 0 ? over > 0.0f : over < 0.0f;
    }

    // The rotation from d, which is beyond some of the faces, to the nearest point of the region. `slot` is that of the
    // worst face.
    RotationLimit RotationToRegion(const Vector3& d, const RotationLimit (&faces)[4], const bool (&isBeyond)[4],
                                   RotationLimit::Slot slot) const {
        RotationLimit best;
        best.error = -2.0f * AngleRange::kHalfTurn;
        for (int face = 0; face < 4; ++face)
            if (isBeyond[face] && faces[face].error > best.error && IsOnFace(face, Foot(face, d))) best = faces[face];
        for (int i = 0; i < 4; ++i) {
            const Vector3 corner = Corner(i), axis = Cross(d, corner);
            const float sine = Length(axis), error = -Atan2(sine, Dot(d, corner));
            if (!(error > best.error)) continue;
            best.error = error;
            best.pole.setZero();
            // At the corner itself the face's axis is used; opposite to it, any perpendicular axis.
            best.axis = sine > 1e-6f    ? Vector3(axis * (1.0f / sine))
                        : error > -1.0f ? faces[slot].axis
                                        : Perpendicular(d);
        }
        best.slot = slot;
        return best;
    }
};

}  // namespace detail

// Neither range locked nor free. Inside, all four faces; outside, the rotation to the nearest point of the pyramid in
// place of the worst face and, if that is small, the other faces: beyond a corner, too, where one row would leave the
// way across it free. The smallest error is the distance to the edge.
inline void AddPyramidLimits(RotationLimitList& list, const SwingTwist& r, const AngleRange& rangeY,
                             const AngleRange& rangeZ) {
    const detail::Pyramid pyramid{{rangeY, rangeZ}};
    const Vector3 d = detail::ToSwingPlane(r.direction);
    RotationLimit faces[4];
    bool isBeyond[4];
    int worst = -1;
    for (int face = 0; face < 4; ++face) {
        faces[face] = pyramid.FaceLimit(face, d);
        isBeyond[face] = pyramid.IsBeyond(face, r.swing);
        if (isBeyond[face] && (worst < 0 || faces[face].error < faces[worst].error)) worst = face;
    }
    const auto add = [&](const RotationLimit& limit) {
        list.Add(limit.slot, limit.error, detail::FromSwingPlane(limit.axis), false,
                 detail::FromSwingPlane(limit.pole));
    };
    constexpr float kShortAngle = 0.1f;  // rad; farther out the circles deviate from the faces
    if (worst >= 0) {
        const RotationLimit back = pyramid.RotationToRegion(d, faces, isBeyond, faces[worst].slot);
        add(back);
        if (back.error < -kShortAngle) return;
    }
    for (int face = 0; face < 4; ++face)
        if (face != worst) add(faces[face]);
}

// Adds the rows of a swing's limits: none if both axes are free, else one to four.
inline void AddSwingLimits(RotationLimitList& list, const SwingTwist& r, const SwingTwistLimits& limits) {
    const AngleRange &y = limits.swingY, &z = limits.swingZ;
    const Vector3& d = r.direction;
    const Vector3 axisY(0, 1, 0), axisZ(0, 0, 1);
    if (y.IsLocked() && z.IsLocked()) {
        // phi along e and across: h = d x e.
        const Vector3 e(0.0f, r.e1, r.e2), h = Cross(d, e);
        list.Add(RotationLimit::SwingYMaximum, r.SwingY(), Vector3(e * r.e1 - h * r.e2), true);
        list.Add(RotationLimit::SwingZMaximum, r.SwingZ(), Vector3(e * r.e2 + h * r.e1), true);
        return;
    }
    // Latitude towards the direction to which rotation about the axis takes x; -z for y, y for z.
    const auto addBand = [&](RotationLimit::Slot slot, const Vector3& pole, const Vector3& across,
                             const AngleRange& range) {
        const RotationLimit north = detail::NorthOf({pole, 0.0f}, d, across);
        constexpr float kQuarterTurn = 0.5f * AngleRange::kHalfTurn;
        if (range.IsLocked()) return list.Add(slot, north.error, north.axis, true, pole);
        if (range.maximum < kQuarterTurn) list.Add(slot, range.maximum - north.error, -north.axis, false, pole);
        if (range.minimum > -kQuarterTurn)
            list.Add(static_cast<RotationLimit::Slot>(slot + 1), north.error - range.minimum, north.axis, false, pole);
    };
    // The longitude of d about `axis`; d . axis is its height above the great circle.
    const auto addLongitude = [&](RotationLimit::Slot slot, const Vector3& axis, float sideways,
                                  const AngleRange& range) {
        if (range.IsFree()) return;
        const float height = Dot(d, axis), scale = Sqrt(d.x() * d.x() + sideways * sideways);
        const Vector3 flat = Normalized(Vector3(d - axis * height), Vector3(1, 0, 0));
        detail::AddRange(list, slot, Atan2(sideways, d.x()), scale, Vector3(axis * scale - flat * height), range);
    };
    if (y.IsLocked() || (z.IsFree() && !y.IsFree())) addBand(RotationLimit::SwingYMaximum, -axisZ, axisY, y);
    if (z.IsLocked() || (y.IsFree() && !z.IsFree())) addBand(RotationLimit::SwingZMaximum, axisY, axisZ, z);
    if (y.IsLocked()) addLongitude(RotationLimit::SwingZMaximum, axisZ, d.y(), z);
    if (z.IsLocked()) addLongitude(RotationLimit::SwingYMaximum, axisY, -d.z(), y);
    if (y.IsLocked() || z.IsLocked() || y.IsFree() || z.IsFree()) return;
    if (limits.shape == SwingShape::Pyramid) return AddPyramidLimits(list, r, y, z);
    const RotationLimit ellipse = EllipseLimit(r, y.maximum, z.maximum);
    list.Add(ellipse.slot, ellipse.error, ellipse.axis, false, ellipse.pole);
}

// The axis about which rotation increases the twist, at the rate 1 / cos(alpha / 2).
inline Vector3 TwistAxis(const SwingTwist& r) { return Vector3(r.swing.w, r.swing.z, -r.swing.y); }

// No row if the range is free, one if it is locked, else one for each end. Outside the range the error is measured to
// the nearer end.
inline void AddTwistLimits(RotationLimitList& list, const SwingTwist& r, const AngleRange& range) {
    if (!range.IsFree()) detail::AddRange(list, RotationLimit::TwistMaximum, r.twist, r.swing.w, TwistAxis(r), range);
}

}  // namespace fulcrum
