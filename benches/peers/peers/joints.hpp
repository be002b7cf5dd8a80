// The joint types that occur here, as a joint collection of Pinocchio: it takes the whole library as a template parameter.
//
// With the 25 types of its default collection the same file takes longer to compile; the times of its algorithms are the same.
#ifndef JOINTS_HPP
#define JOINTS_HPP

#include <pinocchio/multibody.hpp>

namespace pinocchio {

template <typename S, int O> struct FewJointsTpl {
    using Scalar = S;
    static constexpr int Options = O;

    using JointModelRX = JointModelRevoluteTpl<S, O, 0>;
    using JointModelRY = JointModelRevoluteTpl<S, O, 1>;
    using JointModelRZ = JointModelRevoluteTpl<S, O, 2>;
    using JointModelRevoluteUnaligned = JointModelRevoluteUnalignedTpl<S, O>;
    using JointModelPX = JointModelPrismaticTpl<S, O, 0>;
    using JointModelPY = JointModelPrismaticTpl<S, O, 1>;
    using JointModelPZ = JointModelPrismaticTpl<S, O, 2>;
    using JointModelPrismaticUnaligned = JointModelPrismaticUnalignedTpl<S, O>;
    using JointModelFreeFlyer = JointModelFreeFlyerTpl<S, O>;
    using JointModelComposite = JointModelCompositeTpl<S, O, ::pinocchio::FewJointsTpl>;
    using JointModelMimic = JointModelMimicTpl<S, O, ::pinocchio::FewJointsTpl>;
    using JointModelVariant =
        boost::variant<JointModelRX, JointModelRY, JointModelRZ, JointModelRevoluteUnaligned, JointModelPX, JointModelPY,
                       JointModelPZ, JointModelPrismaticUnaligned, JointModelFreeFlyer,
                       boost::recursive_wrapper<JointModelComposite>, boost::recursive_wrapper<JointModelMimic>>;

    using JointDataRX = JointDataRevoluteTpl<S, O, 0>;
    using JointDataRY = JointDataRevoluteTpl<S, O, 1>;
    using JointDataRZ = JointDataRevoluteTpl<S, O, 2>;
    using JointDataRevoluteUnaligned = JointDataRevoluteUnalignedTpl<S, O>;
    using JointDataPX = JointDataPrismaticTpl<S, O, 0>;
    using JointDataPY = JointDataPrismaticTpl<S, O, 1>;
    using JointDataPZ = JointDataPrismaticTpl<S, O, 2>;
    using JointDataPrismaticUnaligned = JointDataPrismaticUnalignedTpl<S, O>;
    using JointDataFreeFlyer = JointDataFreeFlyerTpl<S, O>;
    using JointDataComposite = JointDataCompositeTpl<S, O, ::pinocchio::FewJointsTpl>;
    using JointDataMimic = JointDataMimicTpl<S, O, ::pinocchio::FewJointsTpl>;
    using JointDataVariant =
        boost::variant<JointDataRX, JointDataRY, JointDataRZ, JointDataRevoluteUnaligned, JointDataPX, JointDataPY,
                       JointDataPZ, JointDataPrismaticUnaligned, JointDataFreeFlyer,
                       boost::recursive_wrapper<JointDataComposite>, boost::recursive_wrapper<JointDataMimic>>;
};

} // namespace pinocchio

#endif
