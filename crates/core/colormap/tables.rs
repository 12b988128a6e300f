//! Knots of colour maps: hexadecimal level (0 to 255), red, green and blue (8-bit sRGB). Between two knots linear RGB is linear, which
//! is within 0.75/255 of each of the map's 256 colours in sRGB.
//!
//! Sources: viridis, magma, inferno, plasma (N. Smith, S. van der Walt 2015), cividis (J. Nuñez, C. Anderton, R. Renslow 2018), turbo
//! (A. Mikhailov 2019) and coolwarm (K. Moreland 2009) as of matplotlib 3.11; batlow (F. Crameri 2018) as of cmcrameri 1.10.

/// Knots of each map, in the order of [`NAMES`](super::NAMES).
pub(super) const KNOTS: [&str; 8] = [
    // viridis
    "00440154 09470e61 14481d6f 22472f7d 32414287 4638598c 5f2c718e 7b228c8d 8d1e9d89 9922a884 a22ab07f \
     aa35b779 b242be71 b950c46a c05ec962 c870cf57 d186d549 da9dd93b e2b2dd2d e9c5e021 f0d8e219 f6e7e419 \
     fbf4e61e fffde725",
    // magma
    "00000004 04020109 08030312 0c06051a 120c0926 19140e36 1f1c1044 26251255 2f341069 38440f76 4254137d \
     516b1d81 61842681 719e2f7f 84bd3977 95d8456c 9fe55064 aaf1605d b4f7725c befb8560 c7fd9668 d2feaa74 \
     e0fec488 effde0a1 fefcfbbd fffcfdbf",
    // inferno
    "00000004 03010108 08040312 0d08051d 130e092b 19160b39 20210c4a 272d0b59 303d0965 3a4d0d6c 4762146e \
     567a1d6d 66932667 77ae305c 87c63d4d 92d44842 9ee25734 aaed6925 b4f47918 bdf8890c c4fb9606 c9fc9f07 \
     cefca80d d4fcb418 d9fbbe23 def9c72f e3f7d13d e7f5d949 ebf4e156 eff2e865 f3f1ef75 f8f3f68a fffcffa4",
    // plasma
    "000d0887 061d068e 11330597 1e4903a0 2d6100a7 3c7801a8 478808a6 509511a1 5ba31e9a 68b32c8e 78c43e7f \
     87d24f71 9be26660 adef7c51 c0f89540 d2fdaf31 e0fdc527 edfada24 fbf2f227 fef0f724 fff0f921",
    // cividis
    "0000224e 0800285b 14003070 17013271 28273e6e 3f424e6c 585a5f6e 74727374 807d7c78 97928d78 b2ada272 \
     ccc8b866 e4e2cd54 f9fbe138 fbfde334 fdfee535 fffee838",
    // turbo
    "0030123b 03341b51 06372466 093a2d79 0d3e3891 14424bb5 1c4661d6 224771e9 294682f8 2e448ffe 343d9efe \
     3c2fb2f4 4520c7df 4a1ad2d2 4f18dbc5 5419e3b9 5920eaac 5e2cf09e 6238f491 674af880 6c5dfc6f 7275fe5c \
     788bff4b 7d9cfe40 83acfb38 8abef434 94d7e535 a2f1cb3a aafaba39 b3fea431 bcfd8a26 c2f9781e c7f56918 \
     cdef5811 d3e7490c d9dd3d08 ded43305 e5c52603 eeaf1801 f59b0f01 ff7a0403",
    // batlow
    "00011959 0a0a285c 2d154f62 391c5a62 43256260 4d31695b 59426f52 65557548 71687b3e 7c7b8034 8993872c \
     94a98c2c 9dbb8f33 a5ca923c afdb954b b8e9995c c0f29d6d c8f9a380 d2fdaa97 e1fdb5b8 eefcbfd3 fcfbcaf3 \
     fffaccfa",
    // coolwarm
    "003b4cc0 0a465ecf 175673e0 25688aef 357ea1fa 4594b6ff 57adc9fd 69c4d5f3 76d3dbe7 80dddcdc 90ecd3c5 \
     a0f5c4ac aff7b194 bef59c7d cbee8669 d8e46e56 e5d75445 eecc403a f4c43032 f7c0282f fabb1b2c fbba162b \
     fdb70d28 ffb40426",
];
