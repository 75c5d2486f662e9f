#include <Fulcrum/Collision/Shapes/MassProperties.h>

#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/SizeChecks.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fulcrum {
namespace {

Sym3<double> Sum(const Sym3<double>& a, const Sym3<double>& b, double weightOfB) {
    Sym3<double> s = a;
    s.xx += weightOfB * b.xx;
    s.yy += weightOfB * b.yy;
    s.zz += weightOfB * b.zz;
    s.xy += weightOfB * b.xy;
    s.xz += weightOfB * b.xz;
    s.yz += weightOfB * b.yz;
    return s;
}

Quat<double> ToDouble(const Quaternion& q) { return {q.x, q.y, q.z, q.w}; }

// The rotation matrix as a unit quaternion with w >= 0. Branches on the largest component, which keeps the division
// safe.
Quaternion ToQuaternion(const Mat3<double>& r) {
    const double xx = r.x.x(), yy = r.y.y(), zz = r.z.z();
    double x, y, z, w;
    if (xx + yy + zz > 0) {
        w = 1 + xx + yy + zz;
        x = r.y.z() - r.z.y();
        y = r.z.x() - r.x.z();
        z = r.x.y() - r.y.x();
    } else if (xx >= yy && xx >= zz) {
        w = r.y.z() - r.z.y();
        x = 1 + xx - yy - zz;
        y = r.y.x() + r.x.y();
        z = r.z.x() + r.x.z();
    } else if (yy >= zz) {
        w = r.z.x() - r.x.z();
        x = r.y.x() + r.x.y();
        y = 1 + yy - xx - zz;
        z = r.z.y() + r.y.z();
    } else {
        w = r.x.y() - r.y.x();
        x = r.z.x() + r.x.z();
        y = r.z.y() + r.y.z();
        z = 1 + zz - xx - yy;
    }
    const double scale = std::copysign(1.0, w) / std::sqrt(x * x + y * y + z * z + w * w);
    return {static_cast<float>(x * scale), static_cast<float>(y * scale), static_cast<float>(z * scale),
            static_cast<float>(w * scale)};
}

// One Jacobi rotation in the plane of axes p and q, the third axis is r: annihilates apq. Source: Golub and Van Loan,
// "Matrix Computations", section 8.5.
void JacobiRotate(double& app, double& aqq, double& apq, double& arp, double& arq, Position& axisP, Position& axisQ) {
    if (apq == 0) return;
    const double theta = (aqq - app) / (2 * apq);
    const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    app -= t * apq;
    aqq += t * apq;
    apq = 0;
    const double p = c * arp - s * arq;
    arq = s * arp + c * arq;
    arp = p;
    const Position newP = axisP * c - axisQ * s;
    axisQ = axisP * s + axisQ * c;
    axisP = newP;
}

}  // namespace

void AddOuterProduct(Covariance& c, const Position& v, double weight) {
    const DefaultFloats floats;
    c.xx += weight * v.x() * v.x();
    c.yy += weight * v.y() * v.y();
    c.zz += weight * v.z() * v.z();
    c.xy += weight * v.x() * v.y();
    c.xz += weight * v.x() * v.z();
    c.yz += weight * v.y() * v.z();
}

Sym3<double> InertiaOf(const Covariance& c) {
    const DefaultFloats floats;
    Sym3<double> inertia;
    inertia.xx = c.yy + c.zz;
    inertia.yy = c.xx + c.zz;
    inertia.zz = c.xx + c.yy;
    inertia.xy = -c.xy;
    inertia.xz = -c.xz;
    inertia.yz = -c.yz;
    return inertia;
}

SolidMass PolyhedronMass(std::span<const Position> vertices, std::span<const PolygonRange> polygons,
                         std::span<const int> indices) {
    const DefaultFloats floats;
    Position reference = Position::Zero();
    for (const Position& v : vertices) reference += v;
    reference *= 1.0 / static_cast<double>(vertices.size());

    double sixfoldVolume = 0;
    Position moment = Position::Zero();
    Covariance covariance;
    for (const PolygonRange& polygon : polygons) {
        const auto corner = [&](int i) -> Position { return vertices[indices[polygon.firstIndex + i]] - reference; };
        const Position a = corner(0);
        for (int i = 1; i + 1 < polygon.cornerCount; ++i) {
            const Position b = corner(i), c = corner(i + 1), sum = a + b + c;
            const double determinant = Dot<double>(a, Cross<double>(b, c));
            sixfoldVolume += determinant;
            moment += sum * determinant;
            AddOuterProduct(covariance, a, determinant);
            AddOuterProduct(covariance, b, determinant);
            AddOuterProduct(covariance, c, determinant);
            AddOuterProduct(covariance, sum, determinant);
        }
    }

    SolidMass solid;
    solid.volume = sixfoldVolume / 6;
    const Position shift = moment * (1 / (4 * sixfoldVolume));
    solid.center = reference + shift;
    solid.inertia = InertiaOf(covariance);
    Covariance steiner;
    AddOuterProduct(steiner, shift, 1);
    solid.inertia = Sum(Sum(Sym3<double>{}, solid.inertia, 1.0 / 120), InertiaOf(steiner), -solid.volume);
    return solid;
}

SolidMass CombinedMass(std::span<const SolidMass> solids, std::span<const double> densities) {
    const DefaultFloats floats;
    SolidMass whole;
    double mass = 0;
    Position moment = Position::Zero();
    for (size_t i = 0; i < solids.size(); ++i) {
        whole.volume += solids[i].volume;
        mass += densities[i] * solids[i].volume;
        moment += solids[i].center * (densities[i] * solids[i].volume);
    }
    whole.center = moment * (1 / mass);

    const double toDensityOne = whole.volume / mass;
    for (size_t i = 0; i < solids.size(); ++i) {
        const double density = densities[i] * toDensityOne;
        Covariance steiner;
        AddOuterProduct(steiner, solids[i].center - whole.center, 1);
        whole.inertia = Sum(whole.inertia, solids[i].inertia, density);
        whole.inertia = Sum(whole.inertia, InertiaOf(steiner), density * solids[i].volume);
    }
    return whole;
}

SolidMass Transformed(const SolidMass& solid, const Quaternion& rotation, const Position& translation) {
    const DefaultFloats floats;
    const Mat3<double> r = ToMatrix(ToDouble(rotation));
    SolidMass result;
    result.volume = solid.volume;
    result.center = r * solid.center + translation;
    // R I R^T, column by column: I R^T's columns are I times the rows of R.
    const Sym3<double>& i = solid.inertia;
    const Position rowX(r.x.x(), r.y.x(), r.z.x()), rowY(r.x.y(), r.y.y(), r.z.y()), rowZ(r.x.z(), r.y.z(), r.z.z());
    const Position ix = i * rowX, iy = i * rowY, iz = i * rowZ;
    result.inertia.xx = Dot<double>(rowX, ix);
    result.inertia.yy = Dot<double>(rowY, iy);
    result.inertia.zz = Dot<double>(rowZ, iz);
    result.inertia.xy = Dot<double>(rowX, iy);
    result.inertia.xz = Dot<double>(rowX, iz);
    result.inertia.yz = Dot<double>(rowY, iz);
    return result;
}

SolidMass ToSolidMass(const MassProperties& mass) {
    const DefaultFloats floats;
    SolidMass solid;
    solid.volume = mass.volume;
    solid.center = mass.centerOfMass.cast<double>();
    solid.inertia =
        RotatedDiagonal(ToMatrix(ToDouble(mass.principalAxes)), Position(mass.principalInertia.cast<double>()));
    return solid;
}

PrincipalAxes Diagonalized(const Sym3<double>& tensor) {
    const DefaultFloats floats;
    const double largest = std::max({std::fabs(tensor.xx), std::fabs(tensor.yy), std::fabs(tensor.zz)});
    const auto offDiagonal = [](const Sym3<double>& t) {
        return std::max({std::fabs(t.xy), std::fabs(t.xz), std::fabs(t.yz)});
    };
    if (offDiagonal(tensor) <= 1e-6 * largest) return {Position(tensor.xx, tensor.yy, tensor.zz), Quaternion{}};

    Sym3<double> a = tensor;
    Mat3<double> axes{Position::UnitX(), Position::UnitY(), Position::UnitZ()};
    // Convergence is quadratic; six sweeps reach the last bit of any 3x3 matrix, the rest is margin.
    for (int sweep = 0; sweep < 12 && offDiagonal(a) > 1e-16 * largest; ++sweep) {
        JacobiRotate(a.xx, a.yy, a.xy, a.xz, a.yz, axes.x, axes.y);
        JacobiRotate(a.xx, a.zz, a.xz, a.xy, a.yz, axes.x, axes.z);
        JacobiRotate(a.yy, a.zz, a.yz, a.xy, a.xz, axes.y, axes.z);
    }
    return {Position(a.xx, a.yy, a.zz), ToQuaternion(axes)};
}

Result<MassProperties> ToMassProperties(const SolidMass& solid) {
    const DefaultFloats floats;
    const PrincipalAxes principal = Diagonalized(solid.inertia);
    MassProperties mass;
    mass.volume = static_cast<float>(solid.volume);
    mass.centerOfMass = solid.center.cast<float>();
    mass.principalInertia = principal.values.cast<float>();
    mass.principalAxes = principal.rotation;

    const auto usable = [](double value) {
        return value >= double{std::numeric_limits<float>::min()} && value <= double{std::numeric_limits<float>::max()};
    };
    if (!usable(solid.volume) || !usable(principal.values.minCoeff()) || !usable(principal.values.maxCoeff())) {
        return Error{ErrorCode::OutOfRange,
                     Message("volume %g m3 and moments of inertia %g to %g kg m2 at density 1 must be normal floats: "
                             "choose another unit of length",
                             solid.volume, principal.values.minCoeff(), principal.values.maxCoeff())};
    }
    if (const Status place = CheckPlace("mass", mass.centerOfMass); !place) return place.GetError();
    return mass;
}

}  // namespace fulcrum
