// Fascia's runtime for C#: P/Invoke on libfascia with blittable structures. Works in Unity, Godot and plain .NET or Mono.
//
//     using var asset = Fascia.Asset.Load(File.ReadAllBytes("rig.glb"));
//     using var face = new Fascia.Face(asset);
//     face.Set("arkit:mouthSmileLeft", 0.8f);
//     face.Step(1f / 60);
//     face.WritePositions(0, positions);   // float[3 * vertices] or a pointer into a mapped buffer
//
// Arrays are copied into the caller's; nothing is allocated in a frame. A face is for one thread at a time.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Fascia
{
    public class FasciaException : Exception
    {
        public int Result { get; }
        public FasciaException(int result, string message) : base(message) { Result = result; }
    }

    public enum Space { Mesh = 0, Input = 1, Metres = 2 }
    public enum Combine { Add = 0, Max = 1, Saturate = 2, Override = 3 }

    internal static partial class Native
    {
        const string Library = "fascia";

        [StructLayout(LayoutKind.Sequential)]
        public unsafe struct AssetInfo
        {
            public uint StructSize, LevelCount, MeshCount, ChannelCount, SetCount, MuscleCount;
            public fixed float InputToMetres[16];
        }
        [StructLayout(LayoutKind.Sequential)]
        public struct MeshInfo
        {
            public uint StructSize, Mesh, Primitive, VertexCount, TriangleCount, Reserved;
            public IntPtr Name, Part, Triangles;
        }
        [StructLayout(LayoutKind.Sequential)]
        public struct Channels
        {
            public uint StructSize, Count;
            public IntPtr Names, Groups, Units, Minimum, Maximum, Rest;
        }
        [StructLayout(LayoutKind.Sequential)]
        public struct SetInfo
        {
            public uint StructSize, MemberCount;
            public IntPtr Name, Members;
        }
        [StructLayout(LayoutKind.Sequential)]
        public struct FaceOptions
        {
            public uint StructSize;
            public int Space, Solver, Level, Iterations;
        }
        [StructLayout(LayoutKind.Sequential)]
        public struct Layer
        {
            public uint StructSize;
            public int Combine;
            public float Weight;
            public uint Reserved;
            public IntPtr Mask;
        }

        [DllImport(Library)] public static extern uint fascia_version();
        [DllImport(Library)] public static extern IntPtr fascia_last_message();
        [DllImport(Library)] public static extern unsafe int fascia_asset_load(byte* bytes, UIntPtr size, out IntPtr asset);
        [DllImport(Library)] public static extern void fascia_asset_release(IntPtr asset);
        [DllImport(Library)] public static extern int fascia_asset_get_info(IntPtr asset, ref AssetInfo info);
        [DllImport(Library)] public static extern int fascia_asset_get_mesh(IntPtr asset, uint mesh, ref MeshInfo info);
        [DllImport(Library)] public static extern int fascia_asset_get_channels(IntPtr asset, ref Channels channels);
        [DllImport(Library)] public static extern int fascia_asset_get_set(IntPtr asset, uint set, ref SetInfo info);
        [DllImport(Library)] public static extern unsafe int fascia_asset_find_member(IntPtr asset, byte* name, out uint set, out uint member);
        [DllImport(Library)] public static extern int fascia_face_create(IntPtr asset, ref FaceOptions options, out IntPtr face);
        [DllImport(Library)] public static extern void fascia_face_release(IntPtr face);
        [DllImport(Library)] public static extern IntPtr fascia_face_values(IntPtr face);
        [DllImport(Library)] public static extern IntPtr fascia_face_effective_values(IntPtr face);
        [DllImport(Library)] public static extern unsafe int fascia_face_set(IntPtr face, byte* name, float value);
        [DllImport(Library)] public static extern int fascia_face_set_member(IntPtr face, uint set, uint member, float value);
        [DllImport(Library)] public static extern int fascia_face_clear(IntPtr face);
        [DllImport(Library)] public static extern int fascia_face_pose(IntPtr face);
        [DllImport(Library)] public static extern int fascia_face_step(IntPtr face, float seconds);
        [DllImport(Library)] public static extern int fascia_face_reset(IntPtr face);
        [DllImport(Library)] public static extern int fascia_face_set_level(IntPtr face, int level, float seconds);
        [DllImport(Library)] public static extern int fascia_face_set_layer(IntPtr face, uint index, ref Layer layer);
        [DllImport(Library)] public static extern IntPtr fascia_face_layer_values(IntPtr face, uint layer);
        [DllImport(Library)] public static extern unsafe int fascia_face_layer_set(IntPtr face, uint layer, byte* name, float value);
        [DllImport(Library)] public static extern int fascia_face_layer_set_member(IntPtr face, uint layer, uint set, uint member, float value);
        [DllImport(Library)] public static extern int fascia_face_layer_clear(IntPtr face, uint layer);
        [DllImport(Library)] public static extern int fascia_face_layer_remove(IntPtr face, uint layer);
        [DllImport(Library)] public static extern unsafe int fascia_face_look_at(IntPtr face, float* point, float weight);
        [DllImport(Library)] public static extern int fascia_face_blend(IntPtr face, float share, float seconds);
        [DllImport(Library)] public static extern unsafe int fascia_face_move_head(IntPtr face, float* matrix, float scale);
        [DllImport(Library)] public static extern unsafe int fascia_face_write_positions(IntPtr face, uint mesh, void* to, UIntPtr stride, UIntPtr capacity);
        [DllImport(Library)] public static extern unsafe int fascia_face_write_normals(IntPtr face, uint mesh, void* to, UIntPtr stride, UIntPtr capacity);
        [DllImport(Library)] public static extern unsafe int fascia_face_save(IntPtr face, void* to, UIntPtr capacity, out UIntPtr size);
        [DllImport(Library)] public static extern unsafe int fascia_face_restore(IntPtr face, void* bytes, UIntPtr size);
        [DllImport(Library)] public static extern unsafe int fascia_curves_load(byte* bytes, UIntPtr size, out IntPtr curves);
        [DllImport(Library)] public static extern void fascia_curves_release(IntPtr curves);
        [DllImport(Library)] public static extern int fascia_curves_apply_to_layer(IntPtr curves, double seconds, float weight, IntPtr face, uint layer);

        public static string Text(IntPtr text)
        {
            if (text == IntPtr.Zero) return "";
            int length = 0;
            while (Marshal.ReadByte(text, length) != 0) ++length;
            var bytes = new byte[length];
            Marshal.Copy(text, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }
        public static void Check(int result)
        {
            if (result != 0) throw new FasciaException(result, Text(fascia_last_message()));
        }
        /// A count of bytes or of elements; OverflowException when it is negative.
        public static UIntPtr Size(int count) { return (UIntPtr)checked((uint)count); }
        public static uint Size<T>() where T : struct { return (uint)Marshal.SizeOf(typeof(T)); }
    }

    public struct Channel
    {
        public string Name, Group, Unit;
        public float Minimum, Maximum, Rest;
    }

    /// A vocabulary: its name ("arkit") and those of its members ("jawOpen"), by the indices that Face.SetMember takes.
    public struct Set
    {
        public string Name;
        public string[] Members;
    }

    public struct Mesh
    {
        public string Name, Part;
        public int MeshIndex, PrimitiveIndex, VertexCount;
        public int[] Triangles;
    }

    /// A loaded rig: immutable, for any thread. Faces keep what they need of it.
    public sealed class Asset : IDisposable
    {
        internal IntPtr Handle;
        public Channel[] Channels { get; private set; }
        public Mesh[] Meshes { get; private set; }
        public Set[] Sets { get; private set; }
        public int LevelCount { get; private set; }

        Asset(IntPtr handle) { Handle = handle; }
        ~Asset() { Release(); }
        public void Dispose() { Release(); GC.SuppressFinalize(this); }
        void Release() { Native.fascia_asset_release(Handle); Handle = IntPtr.Zero; }

        public static unsafe Asset Load(byte[] bytes)
        {
            IntPtr handle;
            fixed (byte* data = bytes) Native.Check(Native.fascia_asset_load(data, (UIntPtr)bytes.Length, out handle));
            var asset = new Asset(handle);
            var info = new Native.AssetInfo { StructSize = Native.Size<Native.AssetInfo>() };
            Native.Check(Native.fascia_asset_get_info(handle, ref info));
            asset.LevelCount = (int)info.LevelCount;
            asset.ReadChannels();
            asset.Sets = new Set[info.SetCount];
            for (uint i = 0; i < info.SetCount; ++i) asset.Sets[i] = asset.ReadSet(i);
            asset.Meshes = new Mesh[info.MeshCount];
            for (uint i = 0; i < info.MeshCount; ++i) asset.Meshes[i] = asset.ReadMesh(i);
            return asset;
        }

        unsafe void ReadChannels()
        {
            var list = new Native.Channels { StructSize = Native.Size<Native.Channels>() };
            Native.Check(Native.fascia_asset_get_channels(Handle, ref list));
            Channels = new Channel[list.Count];
            for (int i = 0; i < Channels.Length; ++i)
                Channels[i] = new Channel {
                    Name = Native.Text(((IntPtr*)list.Names)[i]), Group = Native.Text(((IntPtr*)list.Groups)[i]),
                    Unit = Native.Text(((IntPtr*)list.Units)[i]), Minimum = ((float*)list.Minimum)[i],
                    Maximum = ((float*)list.Maximum)[i], Rest = ((float*)list.Rest)[i] };
        }

        unsafe Set ReadSet(uint index)
        {
            var info = new Native.SetInfo { StructSize = Native.Size<Native.SetInfo>() };
            Native.Check(Native.fascia_asset_get_set(Handle, index, ref info));
            var members = new string[info.MemberCount];
            for (int i = 0; i < members.Length; ++i) members[i] = Native.Text(((IntPtr*)info.Members)[i]);
            return new Set { Name = Native.Text(info.Name), Members = members };
        }

        /// Indices of a member by its name, with its set's ("arkit:jawOpen") or without. FasciaException if no set has it.
        public unsafe void FindMember(string name, out int set, out int member)
        {
            uint foundSet, foundMember;
            fixed (byte* text = Encoding.UTF8.GetBytes(name + "\0"))
                Native.Check(Native.fascia_asset_find_member(Handle, text, out foundSet, out foundMember));
            set = (int)foundSet;
            member = (int)foundMember;
        }

        Mesh ReadMesh(uint index)
        {
            var info = new Native.MeshInfo { StructSize = Native.Size<Native.MeshInfo>() };
            Native.Check(Native.fascia_asset_get_mesh(Handle, index, ref info));
            var triangles = new int[3 * info.TriangleCount];
            if (triangles.Length > 0) Marshal.Copy(info.Triangles, triangles, 0, triangles.Length);
            return new Mesh { Name = Native.Text(info.Name), Part = Native.Text(info.Part), MeshIndex = (int)info.Mesh,
                              PrimitiveIndex = (int)info.Primitive, VertexCount = (int)info.VertexCount, Triangles = triangles };
        }
    }

    /// Named values over time: immutable, for any thread.
    public sealed class Curves : IDisposable
    {
        internal IntPtr Handle;
        public unsafe Curves(byte[] bytes)
        {
            fixed (byte* data = bytes) Native.Check(Native.fascia_curves_load(data, (UIntPtr)bytes.Length, out Handle));
        }
        ~Curves() { Native.fascia_curves_release(Handle); }
        public void Dispose() { Native.fascia_curves_release(Handle); Handle = IntPtr.Zero; GC.SuppressFinalize(this); }
    }

    /// One head.
    public sealed unsafe class Face : IDisposable
    {
        IntPtr handle;
        readonly Asset asset;
        readonly byte[] name = new byte[256];

        public Face(Asset asset, Space space = Space.Mesh, int level = -1)
        {
            this.asset = asset;
            var options = new Native.FaceOptions {
                StructSize = Native.Size<Native.FaceOptions>(), Space = (int)space, Level = level };
            Native.Check(Native.fascia_face_create(asset.Handle, ref options, out handle));
        }
        ~Face() { Native.fascia_face_release(handle); }
        public void Dispose() { Native.fascia_face_release(handle); handle = IntPtr.Zero; GC.SuppressFinalize(this); }

        /// The channels' own values, in the library's memory: channel i of asset.Channels.
        public float* Values => (float*)Native.fascia_face_values(handle);
        public float* EffectiveValues => (float*)Native.fascia_face_effective_values(handle);

        /// `text` with a zero behind it, in the face's own array where it fits.
        byte[] Named(string text)
        {
            int count = Encoding.UTF8.GetByteCount(text);
            byte[] bytes = count < name.Length ? name : new byte[count + 1];
            bytes[Encoding.UTF8.GetBytes(text, 0, text.Length, bytes, 0)] = 0;
            return bytes;
        }
        public void Set(string channel, float value)
        {
            fixed (byte* data = Named(channel)) Native.Check(Native.fascia_face_set(handle, data, value));
        }
        /// By the indices of Asset.Sets and its members, which Asset.FindMember gives.
        public void SetMember(int set, int member, float value)
        {
            Native.Check(Native.fascia_face_set_member(handle, (uint)set, (uint)member, value));
        }
        public void Clear() { Native.Check(Native.fascia_face_clear(handle)); }
        public void Apply(Curves curves, double seconds, float weight = 1, int layer = 0)
        {
            Native.Check(Native.fascia_curves_apply_to_layer(curves.Handle, seconds, weight, handle, (uint)layer));
        }
        public void SetLayer(int index, Combine combine, float weight = 1, float[] mask = null)
        {
            if (mask != null && mask.Length != asset.Channels.Length) throw new ArgumentException("one weight a channel");
            fixed (float* data = mask)
            {
                var layer = new Native.Layer { StructSize = Native.Size<Native.Layer>(), Combine = (int)combine,
                                               Weight = weight, Mask = (IntPtr)data };
                Native.Check(Native.fascia_face_set_layer(handle, (uint)index, ref layer));
            }
        }
        /// A layer's own values, as Values; null if there is no such layer.
        public float* LayerValues(int layer) { return (float*)Native.fascia_face_layer_values(handle, (uint)layer); }
        public void LayerSet(int layer, string channel, float value)
        {
            fixed (byte* data = Named(channel)) Native.Check(Native.fascia_face_layer_set(handle, (uint)layer, data, value));
        }
        public void LayerSetMember(int layer, int set, int member, float value)
        {
            Native.Check(Native.fascia_face_layer_set_member(handle, (uint)layer, (uint)set, (uint)member, value));
        }
        public void LayerClear(int layer) { Native.Check(Native.fascia_face_layer_clear(handle, (uint)layer)); }
        public void LayerRemove(int layer) { Native.Check(Native.fascia_face_layer_remove(handle, (uint)layer)); }
        public void LookAt(float x, float y, float z, float weight = 1)
        {
            float* point = stackalloc float[3];
            point[0] = x; point[1] = y; point[2] = z;
            Native.Check(Native.fascia_face_look_at(handle, point, weight));
        }
        public void Blend(float share, float seconds) { Native.Check(Native.fascia_face_blend(handle, share, seconds)); }

        public void Pose() { Native.Check(Native.fascia_face_pose(handle)); }
        /// False when the simulation had to be put back to rest.
        public bool Step(float seconds)
        {
            int result = Native.fascia_face_step(handle, Math.Min(1, seconds));
            if (result == 7) return false;
            Native.Check(result);
            return true;
        }
        public void Reset() { Native.Check(Native.fascia_face_reset(handle)); }
        public void SetLevel(int level, float seconds = 0.25f) { Native.Check(Native.fascia_face_set_level(handle, level, seconds)); }
        /// 16 numbers, column-major: a rigid transform in metres.
        public void MoveHead(float[] matrix, float inertiaScale = 1)
        {
            if (matrix.Length != 16) throw new ArgumentException("a matrix has 16 numbers");
            fixed (float* data = matrix) Native.Check(Native.fascia_face_move_head(handle, data, inertiaScale));
        }

        public void WritePositions(int mesh, float[] to) { fixed (float* data = to) WritePositions(mesh, data, 12, to.Length / 3); }
        public void WritePositions(int mesh, void* to, int stride, int capacity)
        {
            Native.Check(Native.fascia_face_write_positions(handle, (uint)mesh, to, Native.Size(stride), Native.Size(capacity)));
        }
        public void WriteNormals(int mesh, float[] to) { fixed (float* data = to) WriteNormals(mesh, data, 12, to.Length / 3); }
        public void WriteNormals(int mesh, void* to, int stride, int capacity)
        {
            Native.Check(Native.fascia_face_write_normals(handle, (uint)mesh, to, Native.Size(stride), Native.Size(capacity)));
        }

        public byte[] Save()
        {
            UIntPtr size;
            Native.Check(Native.fascia_face_save(handle, null, UIntPtr.Zero, out size));
            var state = new byte[(int)size];
            fixed (byte* data = state) Native.Check(Native.fascia_face_save(handle, data, size, out size));
            return state;
        }
        public void Restore(byte[] state)
        {
            fixed (byte* data = state) Native.Check(Native.fascia_face_restore(handle, data, (UIntPtr)state.Length));
        }
    }
}
