// One case a part: how it is set up from random inputs and what its Jacobian is, written out densely in double. The
// tests of what all parts have in common run over the list at the end.
#pragma once

#include "RandomBodies.h"

#include <Fulcrum/Constraints/Parts/AnglePart.h>
#include <Fulcrum/Constraints/Parts/AxisPart.h>
#include <Fulcrum/Constraints/Parts/DualAxisPart.h>
#include <Fulcrum/Constraints/Parts/GearPart.h>
#include <Fulcrum/Constraints/Parts/HingeRotationPart.h>
#include <Fulcrum/Constraints/Parts/IndependentAxisPart.h>
#include <Fulcrum/Constraints/Parts/PointPart.h>
#include <Fulcrum/Constraints/Parts/RackAndPinionPart.h>
#include <Fulcrum/Constraints/Parts/RotationEulerPart.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <limits>

namespace fulcrum::testing {

// What any part is set up from; axis2 is perpendicular to axis1.
template <class Real>
struct PartInputs {
    Vec3<Real> r1, r2, axis1, axis2, bias;
    Real ratio;
    RowSoftness<Real> softness;
};

inline PartInputs<float> MakeInputs(RandomPoses& random) {
    PartInputs<float> inputs;
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
    m.block<3, 3>(0, 0) = ToDense(mass1.mass).asDiagonal();
    m.block<3, 3>(3, 3) = DenseInertia(mass1);
    m.block<3, 3>(6, 6) = ToDense(mass2.mass).asDiagonal();
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

// A row part as the block parts are called: with masses, without limits, with a bias that is not scaled yet, and with
// sides that belong to the part.
template <class Real, BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
class OneRowPart : public RowPart<Real> {
    using Base = RowPart<Real>;

public:
    using Rows = Real;
    using typename Base::Mask;

    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2) {
        Base::template CalculateProperties<kSide1, kSide2>(mass1, mass2);
    }
    void SetBias(const Real& bias, const RowSoftness<Real>& softness) {
        Base::SetBias(softness.massScale * bias, softness);
    }
    void WarmStart(Twist<Real>& v1, Twist<Real>& v2, const InverseMass<Real>&, const InverseMass<Real>&) const {
        Base::template WarmStart<kSide1, kSide2>(v1, v2);
    }
    Mask SolveVelocity(Twist<Real>& v1, Twist<Real>& v2, const InverseMass<Real>&, const InverseMass<Real>&) {
        const Real unlimited(std::numeric_limits<float>::max());
        return Base::template SolveVelocity<kSide1, kSide2>(v1, v2, -unlimited, unlimited);
    }
    Mask SolvePosition(Twist<Real>& moved1, Twist<Real>& moved2, const InverseMass<Real>&, const InverseMass<Real>&,
                       const Real& error, const Real& baumgarte) const {
        return Base::template SolvePosition<kSide1, kSide2>(moved1, moved2, error, baumgarte);
    }
    Real RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) const {
        return fulcrum::RelativeMotion<kSide1, kSide2>(this->GetJacobian(), motion1, motion2);
    }
};

// What is conserved: all momentum where impulses act on both bodies at one point or in rotation alone. Bearings, guides
// and wheels of a rope, which are no part of the part, take the rest.
enum class Momentum { None, Linear, LinearAndAngular };

// What the parts of one size share. Rounding: numbers are of order 10 and go through about 20 roundings of 6e-8; the
// inverse of a block makes some ten times more of them, as many as K is ill-conditioned, which is below 100 here.
struct BlockCase {
    static constexpr double kMassRounding = 3e-5;  // relative, of the effective mass
    static constexpr double kRounding = 5e-5;
};
struct OneRowCase {
    template <class Real, BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    using Part = OneRowPart<Real, kSide1, kSide2>;
    static constexpr int kRows = 1;
    static constexpr double kMassRounding = 2e-6;
    static constexpr double kRounding = 2e-5;

    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUpRow(OneRowPart<Real, kSide1, kSide2>& part, const InverseMass<Real>& m1,
                         const InverseMass<Real>& m2, const PartInputs<Real>& in, const RowJacobian<Real>& jacobian) {
        part.SetJacobian(jacobian);
        part.CalculateProperties(m1, m2);
        part.SetBias(in.bias.x(), in.softness);
    }
};

struct PointCase : BlockCase {
    template <class Real>
    using Part = PointPart<Real>;
    static constexpr int kRows = 3;
    static constexpr Momentum kKept = Momentum::LinearAndAngular;
    template <class Real>
    static void SetUp(PointPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const PartInputs<Real>& in) {
        part.CalculateProperties(m1, m2, in.r1, in.r2);
        part.SetBias(in.bias, in.softness);
    }
    static DenseRows Jacobian(const PartInputs<float>& in) { return PointRows(in.r1, in.r2); }
};

struct RotationEulerCase : BlockCase {
    template <class Real, BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    using Part = RotationEulerPart<Real, kSide1, kSide2>;
    static constexpr int kRows = 3;
    static constexpr Momentum kKept = Momentum::LinearAndAngular;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(RotationEulerPart<Real, kSide1, kSide2>& part, const InverseMass<Real>& m1,
                      const InverseMass<Real>& m2, const PartInputs<Real>& in) {
        part.CalculateProperties(m1, m2);
        part.SetBias(in.bias, in.softness);
    }
    static DenseRows Jacobian(const PartInputs<float>&) { return AngularRows(); }
};

struct DualAxisCase : BlockCase {
    template <class Real>
    using Part = DualAxisPart<Real>;
    static constexpr int kRows = 2;
    static constexpr Momentum kKept = Momentum::LinearAndAngular;
    template <class Real>
    static void SetUp(DualAxisPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const PartInputs<Real>& in) {
        part.CalculateProperties(m1, m2, {in.r1, in.r2, in.axis1, in.axis2});
        part.SetBias(FirstTwo(in.bias), in.softness);
    }
    static DenseRows Jacobian(const PartInputs<float>& in) {
        Eigen::Matrix<double, 3, 2> axes;
        axes << ToDense(in.axis1), ToDense(in.axis2);
        return axes.transpose() * PointRows(in.r1, in.r2);
    }
};

struct HingeRotationCase : BlockCase {
    template <class Real>
    using Part = HingeRotationPart<Real>;
    static constexpr int kRows = 2;
    static constexpr Momentum kKept = Momentum::LinearAndAngular;
    template <class Real>
    static void SetUp(HingeRotationPart<Real>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const PartInputs<Real>& in) {
        part.CalculateProperties(m1, m2, in.axis1, in.axis2);
        part.SetBias(FirstTwo(in.bias), in.softness);
    }
    static DenseRows Jacobian(const PartInputs<float>& in) {
        Eigen::Matrix<double, 3, 2> axes;
        axes << -ToDense(in.axis2), ToDense(in.axis1);
        return axes.transpose() * AngularRows();
    }
};

struct AxisCase : OneRowCase {
    static constexpr Momentum kKept = Momentum::LinearAndAngular;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(OneRowPart<Real, kSide1, kSide2>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const PartInputs<Real>& in) {
        SetUpRow(part, m1, m2, in, AxisJacobian<Real>({in.r1, in.r2, in.axis1}));
    }
    static DenseRows Jacobian(const PartInputs<float>& in) {
        return ToDense(in.axis1).transpose() * PointRows(in.r1, in.r2);
    }
};

struct AngleCase : OneRowCase {
    static constexpr double kRounding = 1e-5;
    static constexpr Momentum kKept = Momentum::LinearAndAngular;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(OneRowPart<Real, kSide1, kSide2>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const PartInputs<Real>& in) {
        SetUpRow(part, m1, m2, in, AngleJacobian<Real>(in.axis1));
    }
    static DenseRows Jacobian(const PartInputs<float>& in) { return ToDense(in.axis1).transpose() * AngularRows(); }
};

struct GearCase : OneRowCase {
    static constexpr Momentum kKept = Momentum::Linear;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(OneRowPart<Real, kSide1, kSide2>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const PartInputs<Real>& in) {
        SetUpRow(part, m1, m2, in, GearJacobian<Real>(in.axis1, in.axis2, in.ratio));
    }
    static DenseRows Jacobian(const PartInputs<float>& in) {
        DenseRows j = DenseRows::Zero(1, 12);
        j.block<1, 3>(0, 3) = ToDense(in.axis1).transpose();
        j.block<1, 3>(0, 9) = ToDense(in.axis2).transpose() * static_cast<double>(in.ratio);
        return j;
    }
};

struct RackAndPinionCase : OneRowCase {
    static constexpr Momentum kKept = Momentum::Linear;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(OneRowPart<Real, kSide1, kSide2>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const PartInputs<Real>& in) {
        SetUpRow(part, m1, m2, in, RackAndPinionJacobian<Real>({in.r1, in.r2, in.axis1, in.axis2, in.ratio}));
    }
    // The pinion's turn, and the ratio times the way back of the rack's point against the pinion's.
    static DenseRows Jacobian(const PartInputs<float>& in) {
        DenseRows j = ToDense(in.axis2).transpose() * PointRows(in.r1, in.r2) * -static_cast<double>(in.ratio);
        j.block<1, 3>(0, 3) += ToDense(in.axis1).transpose();
        return j;
    }
};

struct IndependentAxisCase : OneRowCase {
    static constexpr Momentum kKept = Momentum::None;
    template <BodySide kSide1, BodySide kSide2, class Real>
    static void SetUp(OneRowPart<Real, kSide1, kSide2>& part, const InverseMass<Real>& m1, const InverseMass<Real>& m2,
                      const PartInputs<Real>& in) {
        SetUpRow(part, m1, m2, in, IndependentAxisJacobian<Real>({in.r1, in.r2, in.axis1, in.axis2 * in.ratio}));
    }
    static DenseRows Jacobian(const PartInputs<float>& in) {
        const Position n1 = in.axis1.cast<double>(), n2 = in.axis2.cast<double>() * static_cast<double>(in.ratio);
        DenseRows j(1, 12);
        j << ToDense(n1).transpose(), ToDense(in.r1.cast<double>().cross(n1)).transpose(), ToDense(n2).transpose(),
            ToDense(in.r2.cast<double>().cross(n2)).transpose();
        return j;
    }
};

using AllParts = ::testing::Types<PointCase, RotationEulerCase, DualAxisCase, HingeRotationCase, AxisCase, AngleCase,
                                  GearCase, RackAndPinionCase, IndependentAxisCase>;

// Those with sides that are known at compile time.
using PartsWithSides =
    ::testing::Types<RotationEulerCase, AxisCase, AngleCase, GearCase, RackAndPinionCase, IndependentAxisCase>;

}  // namespace fulcrum::testing
