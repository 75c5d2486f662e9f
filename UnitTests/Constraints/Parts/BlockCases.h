// One case per block part: its setup from random inputs, and its Jacobian as a dense matrix in double. The tests for
// all block parts run over the list at the end.
#pragma once

#include "RandomBodies.h"

#include <Fulcrum/Constraints/Parts/DualAxisPart.h>
#include <Fulcrum/Constraints/Parts/GearPart.h>
#include <Fulcrum/Constraints/Parts/HingeRotationPart.h>
#include <Fulcrum/Constraints/Parts/IndependentAxisPart.h>
#include <Fulcrum/Constraints/Parts/PointPart.h>
#include <Fulcrum/Constraints/Parts/RackAndPinionPart.h>
#include <Fulcrum/Constraints/Parts/RotationEulerPart.h>

#include <Eigen/Dense>

namespace fulcrum::testing {

// Inputs of any part; axis2 is perpendicular to axis1.
template <class Real>
struct BlockInputs {
    Vec3<Real> r1, r2, axis1, axis2, bias;
    Real ratio;
    RowSoftness<Real> softness;
};

inline BlockInputs<float> MakeInputs(RandomPoses& random) {
    BlockInputs<float> inputs;
    inputs.r1 = random.InBox(1.0f);
    inputs.r2 = random.InBox(1.0f);
    inputs.axis1 = AnyDirection(random);
    inputs.axis2 = Normalized(Cross(inputs.axis1, AnyDirection(random)));
    inputs.bias = random.InBox(1.0f);
    inputs.ratio = random.Between(0.3f, 3.0f);
    return inputs;
}

// Six numbers a body: a row's Jacobian is -J1, J2 where it acts on both sides alike.
using DenseRows = Eigen::Matrix<double, Eigen::Dynamic, 12>;
using Dense3 = Eigen::Matrix3d;

// Vectors as Eigen's columns, so that they take part in products with matrices.
inline Eigen::Vector3d ToDense(const Position& v) { return v; }
inline Eigen::VectorXd ToDense(const Vector3& v) { return ToDense(v.cast<double>()); }
inline Eigen::VectorXd ToDense(const Vec2<float>& v) {
    return Eigen::Vector2d(static_cast<double>(v.x()), static_cast<double>(v.y()));
}

inline Dense3 CrossMatrix(const Vector3& v) {
    const Position r = v.cast<double>();
    Dense3 m;
    m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
    return m;
}
inline Eigen::Matrix<double, 3, 12> PointRows(const Vector3& r1, const Vector3& r2) {
    Eigen::Matrix<double, 3, 12> j;
    j << -Dense3::Identity(), CrossMatrix(r1), Dense3::Identity(), -CrossMatrix(r2);
    return j;
}
inline Eigen::Matrix<double, 3, 12> AngularRows() {
    Eigen::Matrix<double, 3, 12> j;
    j << Dense3::Zero(), -Dense3::Identity(), Dense3::Zero(), Dense3::Identity();
    return j;
}

inline Dense3 DenseInertia(const InverseMass<float>& mass) {
    const SymmetricMatrix3& i = mass.inertia;
    Eigen::Matrix3f m;
    m << i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz;
    return m.cast<double>();
}
inline Eigen::Matrix<double, 12, 12> DenseInverseMass(const InverseMass<float>& mass1,
                                                      const InverseMass<float>& mass2) {
    Eigen::Matrix<double, 12, 12> m = Eigen::Matrix<double, 12, 12>::Zero();
    m.block<3, 3>(0, 0) = Dense3::Identity() * static_cast<double>(mass1.mass);
    m.block<3, 3>(3, 3) = DenseInertia(mass1);
    m.block<3, 3>(6, 6) = Dense3::Identity() * static_cast<double>(mass2.mass);
    m.block<3, 3>(9, 9) = DenseInertia(mass2);
    return m;
}
inline Eigen::Matrix<double, 12, 1> DenseMotion(const Twist<float>& a, const Twist<float>& b) {
    Eigen::Matrix<double, 12, 1> v;
    v << ToDense(a.linear), ToDense(a.angular), ToDense(b.linear), ToDense(b.angular);
    return v;
}

// Rows and effective masses as dense doubles, and single floats of lanes.
inline Eigen::VectorXd ToDense(float a) { return Eigen::VectorXd::Constant(1, static_cast<double>(a)); }
inline Eigen::MatrixXd ToDense(const Sym2<float>& k) {
    Eigen::Matrix2f m;
    m << k.xx, k.xy, k.xy, k.yy;
    return m.cast<double>();
}
inline Eigen::MatrixXd ToDense(const Sym3<float>& k) {
    Eigen::Matrix3f m;
    m << k.xx, k.xy, k.xz, k.xy, k.yy, k.yz, k.xz, k.yz, k.zz;
    return m.cast<double>();
}
inline float RowOf(float a, int) { return a; }
inline float RowOf(const Vec2<float>& a, int row) { return a[row]; }
inline float RowOf(const Vec3<float>& a, int row) { return a[row]; }
template <int N>
Wide<N> RowOf(const Wide<N>& a, int) {
    return a;
}
template <class Rows>
auto RowOf(const Rows& a, int row) {
    return a[row];
}

template <class Real>
Vec2<Real> FirstTwo(const Vec3<Real>& a) {
    return Vec2<Real>(a.x(), a.y());
}

// Whether the part conserves momentum: it acts on both bodies at one point, or in rotation alone.
struct PointCase {
    template <class Real>
    using Part = PointPart<Real>;
    static constexpr int kRows = 3;
    static constexpr bool kKeepsMomentum = true;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(PointPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const BlockInputs<Real>& in) {
        part.template CalculateProperties<kSide1, kSide2>(m1, m2, in.r1, in.r2, in.bias, in.softness);
    }
    static DenseRows Jacobian(const BlockInputs<float>& in) { return PointRows(in.r1, in.r2); }
};

struct RotationEulerCase {
    template <class Real>
    using Part = RotationEulerPart<Real>;
    static constexpr int kRows = 3;
    static constexpr bool kKeepsMomentum = true;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(RotationEulerPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const BlockInputs<Real>& in) {
        part.template CalculateProperties<kSide1, kSide2>(m1, m2, in.bias, in.softness);
    }
    static DenseRows Jacobian(const BlockInputs<float>&) { return AngularRows(); }
};

struct DualAxisCase {
    template <class Real>
    using Part = DualAxisPart<Real>;
    static constexpr int kRows = 2;
    static constexpr bool kKeepsMomentum = true;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(DualAxisPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const BlockInputs<Real>& in) {
        part.template CalculateProperties<kSide1, kSide2>(m1, m2, {in.r1, in.r2, in.axis1, in.axis2}, FirstTwo(in.bias),
                                                          in.softness);
    }
    static DenseRows Jacobian(const BlockInputs<float>& in) {
        Eigen::Matrix<double, 3, 2> axes;
        axes << ToDense(in.axis1), ToDense(in.axis2);
        return axes.transpose() * PointRows(in.r1, in.r2);
    }
};

struct HingeRotationCase {
    template <class Real>
    using Part = HingeRotationPart<Real>;
    static constexpr int kRows = 2;
    static constexpr bool kKeepsMomentum = true;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(HingeRotationPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const BlockInputs<Real>& in) {
        part.template CalculateProperties<kSide1, kSide2>(m1, m2, in.axis1, in.axis2, FirstTwo(in.bias), in.softness);
    }
    static DenseRows Jacobian(const BlockInputs<float>& in) {
        Eigen::Matrix<double, 3, 2> axes;
        axes << -ToDense(in.axis2), ToDense(in.axis1);
        return axes.transpose() * AngularRows();
    }
};

struct GearCase {
    template <class Real>
    using Part = GearPart<Real>;
    static constexpr int kRows = 1;
    static constexpr bool kKeepsMomentum = false;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(GearPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const BlockInputs<Real>& in) {
        part.template CalculateProperties<kSide1, kSide2>(m1, m2, in.axis1, in.axis2, in.ratio, in.bias.x(),
                                                          in.softness);
    }
    static DenseRows Jacobian(const BlockInputs<float>& in) {
        DenseRows j = DenseRows::Zero(1, 12);
        j.block<1, 3>(0, 3) = ToDense(in.axis1).transpose();
        j.block<1, 3>(0, 9) = ToDense(in.axis2).transpose() * static_cast<double>(in.ratio);
        return j;
    }
};

struct RackAndPinionCase {
    template <class Real>
    using Part = RackAndPinionPart<Real>;
    static constexpr int kRows = 1;
    static constexpr bool kKeepsMomentum = false;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(RackAndPinionPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const BlockInputs<Real>& in) {
        part.template CalculateProperties<kSide1, kSide2>(m1, m2, in.axis1, in.axis2, in.ratio, in.bias.x(),
                                                          in.softness);
    }
    static DenseRows Jacobian(const BlockInputs<float>& in) {
        DenseRows j = DenseRows::Zero(1, 12);
        j.block<1, 3>(0, 3) = ToDense(in.axis1).transpose();
        j.block<1, 3>(0, 6) = ToDense(in.axis2).transpose() * -static_cast<double>(in.ratio);
        return j;
    }
};

struct IndependentAxisCase {
    template <class Real>
    using Part = IndependentAxisPart<Real>;
    static constexpr int kRows = 1;
    static constexpr bool kKeepsMomentum = false;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(IndependentAxisPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const BlockInputs<Real>& in) {
        part.template CalculateProperties<kSide1, kSide2>(m1, m2, {in.r1, in.r2, in.axis1, in.axis2, in.ratio},
                                                          in.bias.x(), in.softness);
    }
    static DenseRows Jacobian(const BlockInputs<float>& in) {
        const Position n1 = in.axis1.cast<double>(), n2 = in.axis2.cast<double>() * static_cast<double>(in.ratio);
        DenseRows j(1, 12);
        j << ToDense(n1).transpose(), ToDense(in.r1.cast<double>().cross(n1)).transpose(), ToDense(n2).transpose(),
            ToDense(in.r2.cast<double>().cross(n2)).transpose();
        return j;
    }
};

}  // namespace fulcrum::testing
