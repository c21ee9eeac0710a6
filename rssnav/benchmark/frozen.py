"""Fingerprints of the buildings of this version: 300 generated ones in three splits, the paper's.

`tests/benchmarks/freeze_buildings.py` writes this module for the next version.
"""

from __future__ import annotations

from typing import Literal

Split = Literal["train", "validation", "test"]

TEXT: dict[Split | Literal["paper"], str] = {
    "train": """
        23aad804 71c57fae 61a315e7 a8b766ca 002fc1d9 ae76c175 cf71dc9e 6abe73c0 a50a8754 d2a63c50
        bb18f7da 4124b99f 006b8f13 ffe3fc65 def0128c 826ba7ea 9015163a 48633444 e178b9a1 bcdbb604
        932bdabc 4e4dc5d2 6e8bc8b8 292175af 9fd0e68f 4165f76b 4ce08d4b be84e01e 443d2c27 4ddbc06f
        fa681d3d 91257e64 a87bb382 e8fcc287 c1413a09 59144b06 f45a923b 1cd4f546 afe36aca 4f8d3799
        bbfc6eaa 8d68bf11 c7daf9bf 3476c265 5bd69910 b994d1f3 3a3b4e46 f9f6d297 9b1376f5 f5dcc453
        1ecad13c 896ed446 e7c88782 9d590964 eb8b11c1 3d82ab05 228b22f4 f9e28dd4 0f49527b 40440667
        7a3ee3b9 82145149 f4336a06 e3ed93cd a896df4c 4a98719b 42dcbb93 935e3972 e5e26e92 2048ebcd
        b23082d3 1ba540e3 a38cea85 17ef76db 5ce1b6f5 306b5ab7 cedff4bc 6ed28830 a7931221 c1535080
        148362db 9d645a79 3060d5a2 f13da7db 5e2f5360 d5657c56 c3c7df50 402fc430 8a81a3c8 f2aafd86
        e50c86e7 5fd59df1 08bf335a bc4e681d fbf64316 3d7e5f0d d53725ba 4ac4fafa 03d4a6ce 5aae9720
        1f8b234b 4458e584 36d3a40b 0e83120f 5a275f86 d07c3616 1fca877e 83253d65 84ead1e9 0e7d4e5d
        df453210 704d1526 d3aa67bd 89dc4e73 572bb00a e84457e8 7b669c37 b6284dfe 98d1c337 d588c1de
        a2d8c4c4 7afb9a27 ac06a962 e254dbdc 24498473 b4e90030 36ff65fb da71a72e 9bb12362 46361944
        f9b6a741 53f129c0 322509b6 d4fb1194 49a1bca0 c20b3cde ae7a66bf b1e7adb1 101eeae8 279d876d
        acf61f49 e8f8739b d96e7498 d5d725ae 53df7068 fd0f0d4a 6b6ba039 6d0984f8 544a7b5a e36f4533
        87d56a99 8a8a2d41 3fc35246 6361f4d2 6e8db2ea 2ac1ce7e 6c47fb05 0c68c6b2 7efa5c6a 8d188c64
        db70708f 42450453 5afb51eb 003527f3 3135810d dc899992 58de58df 26fa7e69 bad78054 b318da03
        72116f3d 6ebc19ed d228394f 597dda1f c5f513d3 b9428b0b cb595a42 741b7e8b c173eda9 f62b161d
        6042713f e9790ffd c292893c 991740ed bb63d8e8 dbd15561 3bdc9308 5cdb7322 9d09d0d9 0f974b09
        688051e8 12000b63 6cd315ad eaca7798 6b3cb723 5e9d1df5 494cd4a6 f3509b68 0edc2539 5ec86f57
    """,
    "validation": """
        90a2d479 da20c4f6 6503e7a8 b5006405 f69a4e11 7fd92e5c 7d17bca6 f58b12e5 cf26f0e6 e6c09e32
        a07a345f 5e191a46 598dc21d 8af3c4e0 701c4eda 5c6189c5 7ab514bb 154dfbe3 8c59e0d1 a5a57572
        e4bbb2f7 3fa4cf22 14403040 6b7e9ad2 ab649379 7b68e727 373ec2f6 7d3d7351 0b8d20cc 220e28a9
        e9155983 2d63019e 6cedcfcc 6273866d 08510f5a 7eebad3e a13bc217 1b25c06c bfd2ed02 7bc5a11c
        a98456f3 224e8dc8 880ea826 6cd05318 08c87b2c e1b030fa 57127b54 d2c13728 5ddfb34a 127e02b0
    """,
    "test": """
        232b3d2d 47544702 ba373820 03a3669e b674a6e0 67015011 5284b48c 20e89a8c 84965400 0a397c83
        b0a22232 e08050ab 141e6a88 438f214a d3a236b4 76aba1fb faf8a3d2 5e6a7f36 cfd83e3a 0d7c7d58
        b3fffe48 4ccbb3d9 c5844c2e a47dc40c 0578e819 363a90cf 28f56fad cdcb2d47 320ab78b 8a71e6ae
        b4e2d04b bc9f85a0 c445c5d7 ea31e085 9810da99 1c55425e 6bb9a6f0 95eeb2ea 2572a4d8 86b05c5f
        98f1634f 89dc0375 3a37edce 2cc96295 a67c9c3b faf025d2 c1c8c450 a99a984d ad8ccfbb 7e50ce85
    """,
    "paper": """
        97040628 93ad5b92
    """,
}

DOOR_TEXT: dict[Split, str] = {
    "train": """
        a02a1ac0 153f4e85 9f41e6cf 4fc6e296 2aa8e248 2b0ab1be 9cd263f2 646a2e13 d0051219 0ee1da32
        1d87ea6b 404259d7 61ee43e9 3dc5bd6b 66473fcc 235916c2 38b31922 8e225d31 c3fd9777 298e013d
        72cb98b8 004a5fd8 6e431957 992208f1 508badf3 e9cd983a 11bd91de 56c4fa31 62a9d60b 475acf81
        3cacaa4a efbff3fb 2ae3d47f 61697535 5ec90990 094fa562 4df987dd 91e9b8f5 07ac32f3 5e031f2e
        c98d6f08 ba431b5b 708f8206 63a595bd 9124439c 3a4892ca 36f28dce 7664a31d 652ee1b1 7669098c
        52f2213d a21a45ef 1cd892e7 bb7f5125 ddd7da76 27b2ebb4 ad43dea4 4a52322b b874547b 23dd8059
        946442a3 52b5c762 7ae3bf5e 247b4311 29329681 e2c1eb85 becb4845 62998170 7c67f1cb c30bccba
        4333a8ad 45fa9b07 512bc233 b3354c20 e319206f e5394d0c 7cf52017 44bbc639 df2051a6 6165ac5f
        bf0371f2 619b44c0 b3d81562 2fe711e6 27ce8e6f 5654313b 3965460e 0e8024a0 00a91554 7af71d82
        bc4271fa ac3f5bf6 0064ab20 fbedaf11 0d80eee0 d21054a1 98d56519 64e8dca6 901dd580 badcd8ab
        65b421a0 06ee8ea6 904770ff 92ef1e3a 393af611 d75687a8 854f460a 1fd6600a 9669f2f4 08b54156
        76eee6c7 c49d4b82 52fb4543 dbdc9cbc 2baa9b33 1ae1ab9b 03a4444f f5b7a9bd 280c28c0 6d3202d5
        e30f8394 99c58ea8 144f4411 57d39c20 fe78b6a0 d10033e8 ffac2e3b 0e44361f 77771a9b 56197d02
        cb248aeb 0a608f69 cc06edd8 fbca39b0 86cfe55b 06f5fee9 0c2be25c ad3ec212 97accfa9 e16503d2
        aca1b2d8 733aeb89 872f6e3e 743ea4f9 528ccea1 e6486ca2 1e083cd2 69351a17 f3972e97 f2005aae
        d2413dc2 cc239eb5 ece8da36 0fb72748 b55ee2df 29056e88 6cdf7d53 207d0efc fd7d640a 66588bbe
        98bddc4c 51303a4b 0dd5692c a28f56e8 e2fdec5e afc96080 131f6f67 927d0ad4 5aec65e0 9f369864
        6a931e53 21c8c1ef 83b1ed75 00e54914 e4a7ddbc 7cdd6ce3 a4b2a2cd 5a3e94af d151e24d 5d8487ad
        58faf876 ed29ecb5 dc41ad86 0d0172f7 b0e82b30 507a1f74 f7673d58 00551f4c 2a957b8f d9bb06b8
        cc5436b6 23bd85e7 02164e79 aac6ac33 9caebebe aa569694 37df3182 679f74fc 4ef67660 bc0903db
    """,
    "validation": """
        edfa1024 1dee370a c06ad3e0 5bb83e97 0f4fb882 752cc9db 3825f5ad dd15db9b 10a48845 73bd8cea
        afb32c49 7de6a396 40165715 b37816f9 26db2149 581a1492 c717b3cc 9a0a9289 d1d7716d 0fd6785c
        e01748b4 c330bea7 1dcaee56 c73564b2 07d6799f 305461a0 2ae0ca32 8b1bbe38 df264a4e e23fe6b3
        58c9016c 2776b964 74ee096f d412b07b c9fb82b5 c806e250 29622c7e 0cf3c78e 872c8aeb e7e1ab7d
        d69d3d48 d7aaf665 f65f964b 70e99a18 e7783633 b4361a8b ad66fe04 069abf09 28495b23 b5b209f9
    """,
    "test": """
        5dad4571 604efe3e b27284ca 62d4d43d 49b2b620 2158c6a4 78de9156 16978d50 f7deb69e b66cd26c
        6f252a6d d251e5cc da3bc4ec 9e3de821 b55218c4 a399dc65 7669c629 d5763d12 f5ab5746 219e1c06
        2e2e1ee6 39106084 62bfb6a1 d9755302 cfee9bea a0cd0240 9eed1a7e c026cb4a c40d345b 4124eb3e
        f0be658a 3e46255d f5976241 df801e36 7bc7fcdf 67cd055e ebca28fc d5911d6b 78494b28 6f583592
        427eebf8 6311f892 b6089350 52439846 2b6b8059 59cb7256 9510890d 3c226eca 477a1440 db62774b
    """,
}

FINGERPRINTS: dict[str, list[str]] = {site: text.split() for site, text in TEXT.items()}
"""First 8 hexadecimal digits of the hash of each building's plan and transmitters, in order."""

DOOR_FINGERPRINTS: dict[str, list[str]] = {site: text.split() for site, text in DOOR_TEXT.items()}
"""The same of each generated building with doors that open and close."""
