// Prints the layout of every struct as the runtime has it.
using System;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Text.RegularExpressions;

public static class Layout
{
    public static void Main()
    {
        foreach (Type type in typeof(Packcell.Raw).GetNestedTypes())
        {
            // Handles are classes; int32_x2 and the like are arrays within structs.
            if (!type.IsValueType || Regex.IsMatch(type.Name, "_x[0-9]+$"))
                continue;
            Console.WriteLine(type.Name + " " + Marshal.SizeOf(type));
            foreach (FieldInfo field in type.GetFields())
                Console.WriteLine(type.Name + "." + field.Name + " "
                                  + Marshal.OffsetOf(type, field.Name));
        }
    }
}
